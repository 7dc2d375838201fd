"""Visible draws as rows with keys, and their instances: arrays only."""

import numpy as np
from numpy.typing import NDArray

from moka.commands.draws import DRAW, INSTANCE, Draws, Instances
from moka.commands.sort_key import (
    MATERIAL_BITS,
    MESH_BITS,
    PROGRAM_BITS,
    pack_blended_keys,
    pack_opaque_keys,
)
from moka.renderer.prepared_scene import PreparedScene
from moka.renderer.view import View
from moka.scene.culling import view_depths
from moka.scene.drawables import Drawables
from moka.scene.transforms import TransformTree

__all__ = ["DrawGatherer"]


class DrawGatherer:
    """Gathers the draws of one prepared scene, frame after frame.

    What only moves with the camera is computed for a frame; what only moves
    with the objects is kept until one of them moves.
    """

    def __init__(
        self,
        drawables: Drawables,
        prepared: PreparedScene,
        poses: NDArray[np.uint32] | None = None,
    ) -> None:
        """``poses`` (D, 2) are the places of draws in the pose texture."""
        self._drawables = drawables
        rows = prepared.rows[drawables.primitive]
        count = len(rows)
        self._draws = np.zeros(count, DRAW)
        for name in ("program", "bind_group", "mesh"):
            self._draws[name] = rows[name]
        self._draws["instance_count"] = 1
        self._state = rows["state"].astype(np.intp)
        self._layer = rows["layer"]
        self._blended = rows["blended"]
        self._instances = np.zeros(count, INSTANCE)
        self._instances["material"] = rows["material"]
        self._instances["object"] = drawables.object
        if poses is not None:
            self._instances["spare"] = poses
        self._positions = np.zeros((count, 3))
        self._version = -1

    def gather(
        self,
        transforms: TransformTree,
        visible: NDArray[np.intp],
        view: View,
        states: NDArray[np.uint32],
        pass_: int,
    ) -> tuple[Draws, Instances]:
        """Rows of DRAW and INSTANCE for the draws ``visible`` (V,).

        ``states`` maps the prepared scene's state numbers to the command
        list's, ``pass_`` is the frame's pass that they belong to.
        """
        drawables = self._drawables
        if self._version != transforms.version:
            self._version = transforms.version
            world = transforms.world[drawables.row, :3]
            if drawables.poses is not None:
                drawables.poses.place(world)
            # What float32 cannot hold is infinite, and not drawn.
            with np.errstate(over="ignore"):
                self._instances["transform"] = world
            self._positions = world[:, :, 3]
        draws = self._draws.take(visible)
        draws["state"] = states[
            self._state[visible] + drawables.mirrored[visible]
        ]
        draws["first_instance"] = np.arange(len(visible))
        depth = view_depths(view.matrix, drawables.world_bounds[visible])
        draws["key"] = self._keys(draws, visible, depth, pass_)
        instances = self._instances.take(visible)
        # In double precision, before anything is rounded.
        with np.errstate(over="ignore", invalid="ignore"):
            instances["transform"][:, :, 3] = (
                self._positions[visible] - view.position
            )
        return draws, instances

    def _keys(
        self,
        draws: Draws,
        visible: NDArray[np.intp],
        depth: NDArray[np.float64],
        pass_: int,
    ) -> NDArray[np.uint64]:
        # Slots of handles can exceed a field, whose bits only group draws.
        program = draws["program"] & np.uint32((1 << PROGRAM_BITS) - 1)
        material = draws["bind_group"] & np.uint32((1 << MATERIAL_BITS) - 1)
        layer = self._layer[visible]
        keys = pack_opaque_keys(
            pass_=pass_,
            layer=layer,
            program=program,
            material=material,
            mesh=draws["mesh"] & np.uint32((1 << MESH_BITS) - 1),
            depth=depth,
        )
        blended = self._blended[visible]
        if blended.any():
            keys[blended] = pack_blended_keys(
                pass_=pass_,
                layer=layer[blended],
                program=program[blended],
                material=material[blended],
                depth=depth[blended],
            )
        return keys
