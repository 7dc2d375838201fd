"""Visible draws as rows with keys, and their instances: arrays only."""

import numpy as np
from numpy.typing import NDArray

from moka.commands.draws import DRAW, INSTANCE, Draws, Instances
from moka.commands.sort_key import (
    MATERIAL_BITS,
    MESH_BITS,
    PROGRAM_BITS,
    blended_at,
    opaque_at,
    pack_blended_keys,
    pack_opaque_keys,
)
from moka.core.maths import Array
from moka.renderer.prepared_scene import PreparedScene
from moka.renderer.view import View
from moka.scene.culling import view_depths
from moka.scene.drawables import Drawables
from moka.scene.transforms import TransformTree

__all__ = ["DrawGatherer"]

# Opaque draws stay in their order while depths have changed by less than
# this part of what they typically are: then it is still front to back, by
# which nothing but time is won.
_SAME_DEPTHS = 0.1


class DrawGatherer:
    """Gathers the draws of one prepared scene, frame after frame.

    What only moves with the camera is computed for a frame; what only moves
    with the objects is kept until one of them moves, and so is the order of
    opaque draws until the camera has gone some way.
    """

    def __init__(
        self,
        drawables: Drawables,
        prepared: PreparedScene,
        pass_: int,
        poses: NDArray[np.uint32] | None = None,
        places: NDArray[np.uint32] | None = None,
        triangle_bits: int = 0,
    ) -> None:
        """``pass_`` is the frame's pass that the draws belong to.

        ``poses`` (D, 2) are the places of draws in the pose texture.
        ``places`` (P, 2), for a visibility buffer, are of the prepared
        scene's primitives what is added to their indices and where these
        begin. Instances then tell the first in the place of the object, and
        to spare their row, shifted by ``triangle_bits``, and the second with
        its highest bit set where they are mirrored.
        """
        self._drawables = drawables
        rows = prepared.rows[drawables.primitive]
        count = len(rows)
        self._draws = np.zeros(count, DRAW)
        for name in ("program", "bind_group", "mesh"):
            self._draws[name] = rows[name]
        self._draws["instance_count"] = 1
        self._draws["key"] = _keys(rows, pass_)
        self._state = rows["state"].astype(np.intp)
        self._blended: NDArray[np.bool_] | None = rows["blended"]
        if not rows["blended"].any():
            self._blended = None
        self._instances = np.zeros(count, INSTANCE)
        self._instances["material"] = rows["material"]
        self._instances["object"] = drawables.object
        if poses is not None:
            self._instances["spare"] = poses
        self._triangle_bits = np.uint32(triangle_bits)
        if places is not None:
            base_vertex, first = places[drawables.primitive].T
            mirrored = drawables.mirrored.astype(np.uint32)
            self._instances["object"] = base_vertex
            self._instances["spare"][:, 1] = first | mirrored << np.uint32(31)
        self._positions = np.zeros((3, count))
        self._version = -1
        self._sorted: _Sorted | None = None

    def gather(
        self,
        transforms: TransformTree,
        visible: NDArray[np.intp],
        view: View,
        states: NDArray[np.uint32],
    ) -> tuple[Draws, Instances]:
        """Rows of DRAW and INSTANCE for the draws ``visible`` (V,).

        Rows are in the order of their keys and instances in that of the
        rows. ``states`` maps the prepared scene's state numbers to the
        command list's.
        """
        self._follow(transforms)
        kept = self._sorted
        if kept is None or not kept.serves(visible, view, states):
            kept = self._sorted = self._sort(visible, view, states)
        instances = kept.instances.copy()
        # In double precision, before anything is rounded.
        with np.errstate(over="ignore", invalid="ignore"):
            for axis in range(3):
                np.subtract(
                    kept.positions[axis],
                    view.position[axis],
                    out=instances["transform"][:, axis, 3],
                    casting="same_kind",
                )
        return kept.draws, instances

    def _follow(self, transforms: TransformTree) -> None:
        """Take over what moved since the last call."""
        if self._version == transforms.version:
            return
        self._version = transforms.version
        self._sorted = None
        drawables = self._drawables
        world = transforms.world[drawables.row, :3]
        if drawables.poses is not None:
            drawables.poses.place(world)
        # What float32 cannot hold is infinite, and not drawn.
        with np.errstate(over="ignore"):
            self._instances["transform"] = world
        self._positions = np.ascontiguousarray(world[:, :, 3].T)

    def _sort(
        self,
        visible: NDArray[np.intp],
        view: View,
        states: NDArray[np.uint32],
    ) -> "_Sorted":
        drawables = self._drawables
        depth = view_depths(view.matrix, drawables.boxes[:, visible])
        keys = self._draws["key"][visible]
        blended = (
            None
            if self._blended is None
            else np.flatnonzero(self._blended[visible])
        )
        placed = opaque_at(keys, depth)
        if blended is not None:
            placed[blended] = blended_at(keys[blended], depth[blended])
        order = np.argsort(placed, kind="stable")
        rows = visible[order]
        draws = self._draws.take(rows)
        draws["key"] = placed[order]
        draws["state"] = states[self._state[rows] + drawables.mirrored[rows]]
        draws["first_instance"] = np.arange(len(rows))
        instances = self._instances.take(rows)
        if self._triangle_bits:
            instances["spare"][:, 0] = (
                draws["first_instance"] << self._triangle_bits
            )
        return _Sorted(
            visible,
            states,
            view,
            _middle(depth),
            draws,
            instances,
            self._positions.take(rows, axis=1),
            # What is blended must be in its exact order.
            lasts=blended is None or not len(blended),
        )


class _Sorted:
    """The draws of a frame in order, as long as they serve other frames."""

    def __init__(
        self,
        visible: NDArray[np.intp],
        states: NDArray[np.uint32],
        view: View,
        depth: float,
        draws: Draws,
        instances: Instances,
        positions: Array,
        *,
        lasts: bool,
    ) -> None:
        """``depth`` is a typical one, ``positions`` (3, V) of objects."""
        self._visible = visible
        self._states = states
        self._view = view
        self._depth = depth
        self._lasts = lasts
        self.draws = draws
        self.instances = instances
        self.positions = positions

    def serves(
        self,
        visible: NDArray[np.intp],
        view: View,
        states: NDArray[np.uint32],
    ) -> bool:
        """Whether another frame may draw the same in the same order."""
        turned = view.matrix[2, :3] - self._view.matrix[2, :3]
        moved = view.position - self._view.position
        return (
            self._lasts
            and float(turned @ turned) < _SAME_DEPTHS**2
            and float(moved @ moved) < (_SAME_DEPTHS * self._depth) ** 2
            and np.array_equal(states, self._states)
            and np.array_equal(visible, self._visible)
        )


def _keys(rows: NDArray[np.void], pass_: int) -> NDArray[np.uint64]:
    """Keys of depth 0 for rows of a prepared scene."""
    # Slots of handles can exceed a field, whose bits only group draws.
    program = rows["program"] & np.uint32((1 << PROGRAM_BITS) - 1)
    material = rows["bind_group"] & np.uint32((1 << MATERIAL_BITS) - 1)
    keys = pack_opaque_keys(
        pass_=pass_,
        layer=rows["layer"],
        program=program,
        material=material,
        mesh=rows["mesh"] & np.uint32((1 << MESH_BITS) - 1),
    )
    blended = rows["blended"]
    keys[blended] = pack_blended_keys(
        pass_=pass_,
        layer=rows["layer"][blended],
        program=program[blended],
        material=material[blended],
    )
    return keys


def _middle(values: Array) -> float:
    """The median, or the upper of two; 0 without any.

    NumPy's own imports its masked arrays, which takes 10 ms.
    """
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle]) if len(values) else 0.0
