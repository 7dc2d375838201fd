"""What a scene draws, flattened: one row per primitive of each instance.

Built when models come or go. While things only move, the boxes of the rows
that moved are all that is computed.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError, OptionError
from moka.core.maths import Array, is_mirrored, transform_bounds, union_bounds
from moka.material.material import Material
from moka.model.mesh import Primitive
from moka.model.model import Model
from moka.scene.culling import pack_boxes
from moka.scene.forest import Rows
from moka.scene.transforms import TransformTree, check_affine

if TYPE_CHECKING:
    from moka.scene.animation_clips import Clips
    from moka.scene.level_of_detail import DetailLevels
    from moka.scene.morph_weights import MorphWeights
    from moka.scene.poses import Poses

__all__ = ["Drawables", "ModelLayout"]


class ModelLayout:
    """The primitives that one scene of a model places, and at which nodes.

    ``primitives`` are those of the meshes in use. Of D draws, ``node`` (D,)
    is the row in the model's nodes, ``primitive`` (D,) the position in
    ``primitives``, ``bounds`` (D, 2, 3) the box in the node's space and
    ``skin`` (D,) the position in the model's skins, -1 for what is rigid;
    ``levels`` are their levels of detail, None without any. ``deforms``
    tells whether there are skins or morph targets.
    ``cameras`` and ``lights`` are pairs of a node's row and what it places.
    Copies of a model in one scene and variant share all this.

    Raises ModelError if the model has no such scene, or nodes whose matrices
    are not affine.
    """

    def __init__(
        self, model: Model, scene: int, variant: int | None = None
    ) -> None:
        try:
            check_affine(model.nodes.local, (len(model.nodes),))
        except OptionError as error:
            where = model.path or model.name or "a model"
            raise ModelError(f"{where}: nodes: {error}") from error
        self.model = model
        self.scene = scene
        self.variant = variant
        nodes, instances = model.instances(scene)
        used, mesh = np.unique(instances, return_inverse=True)
        meshes = [model.meshes[index].primitives for index in used.tolist()]
        self.primitives: list[Primitive] = [
            primitive.of_variant(variant)
            for primitives in meshes
            for primitive in primitives
        ]
        count = np.array([len(primitives) for primitives in meshes], np.intp)
        first = np.cumsum(count) - count
        draws = count[mesh]  # Of each instance.
        before = np.cumsum(draws) - draws
        within = np.arange(draws.sum()) - np.repeat(before, draws)
        self.cameras = _pairs(model.camera_instances(scene))
        self.lights = _pairs(model.light_instances(scene))
        self.node: Rows = np.repeat(nodes.astype(np.intp), draws)
        self.primitive: Rows = np.repeat(first[mesh], draws) + within
        self.levels: DetailLevels | None = None
        if model.nodes.levels is not None or any(
            primitive.material is not None and primitive.material.coarser
            for primitive in self.primitives
        ):
            self._find_levels()
        self.skin: Rows = np.full(len(self.node), -1)
        if any(primitive.influence_sets for primitive in self.primitives):
            self._find_skins()
        self.deforms = bool((self.skin >= 0).any()) or any(
            primitive.targets is not None for primitive in self.primitives
        )
        boxes = [primitive.bounds for primitive in self.primitives]
        self.bounds: Array = np.reshape(
            np.array(boxes, np.float64), (-1, 2, 3)
        )[self.primitive]

    def _find_levels(self) -> None:
        """Make draws of all levels of materials, and see whose they are."""
        from moka.scene.level_of_detail import (
            joined_levels,
            material_levels,
            node_levels,
        )

        self.primitives, self.primitive, copied, levels = material_levels(
            self.primitives, self.primitive
        )
        self.node = self.node[copied]
        self.levels = joined_levels(
            [(levels, 0), (node_levels(self.model.nodes, self.node), 0)]
        )

    def with_materials(self, own: Mapping[Material, Material]) -> "ModelLayout":
        """The same with other materials in place of some; itself for none.

        Geometry and animations stay those of all copies.
        """
        if not own:
            return self
        made = copy(self)
        made.clips = self.clips
        made.primitives = [
            primitive.with_material(own[primitive.material])
            if primitive.material is not None and primitive.material in own
            else primitive
            for primitive in self.primitives
        ]
        return made

    @cached_property
    def clips(self) -> "Clips":
        """The model's animations, as its copies share them."""
        from moka.scene.animation_clips import Clips

        return Clips(self.model)

    def _find_skins(self) -> None:
        """Set ``skin``; rigid draws get primitives that follow no joints."""
        skin_of_node = np.full(len(self.model.nodes), -1)
        for row, skin in self.model.nodes.skins.items():
            skin_of_node[row] = skin
        follows = np.array(
            [bool(each.influence_sets) for each in self.primitives]
        )[self.primitive]
        self.skin = np.where(follows, skin_of_node[self.node], -1)
        loose = follows & (self.skin < 0)
        for position in np.unique(self.primitive[loose]).tolist():
            rigid = self.primitives[position].as_rigid()
            alike = self.primitive == position
            if loose[alike].all():
                self.primitives[position] = rigid
            else:
                self.primitive[alike & loose] = len(self.primitives)
                self.primitives.append(rigid)


# What a row of Drawables has.
_COLUMNS = (
    "primitive",
    "row",
    "owner",
    "local_bounds",
    "world_bounds",
    "mirrored",
    "object",
    "points",
)


class Drawables:
    """The draws of all models of a scene, D of them.

    Made of the models' layouts and, for each, the transform rows of its
    nodes. ``primitives`` holds every primitive once; ``primitive`` (D,) is
    the position in it, ``row`` (D,) the row of the transform, ``owner`` (D,)
    the position of the model. ``object`` (D,) is 1 and the number of the
    node, counted on from model to model. ``local_bounds`` and
    ``world_bounds`` are float64 (D, 2, 3), least and greatest corner,
    ``boxes`` (6, D) the same as :mod:`moka.scene.culling` reads them;
    ``mirrored`` (D,) tells where the world matrix turns front faces
    clockwise. The last two are as of the last :meth:`refresh`. ``levels``
    are the levels of detail that draws belong to, ``poses`` those of skins
    and morph targets, both None without any; ``total`` is how many draws
    there were before :meth:`only`.
    """

    def __init__(
        self,
        layouts: Sequence[ModelLayout] = (),
        node_rows: Sequence[Rows] = (),
        weights: Sequence["MorphWeights | None"] = (),
    ) -> None:
        self.primitives, primitive_of = _joined(layouts)
        none = np.empty(0, np.intp)
        placed = list(zip(layouts, node_rows, strict=True))
        self.primitive: Rows = np.concatenate(
            [none, *(primitive_of[id(layout)] for layout in layouts)]
        )
        self.row: Rows = np.concatenate(
            [none, *(rows[layout.node] for layout, rows in placed)]
        )
        self.owner: Rows = np.repeat(
            np.arange(len(layouts)), [len(layout.node) for layout in layouts]
        )
        nodes = [len(layout.model.nodes) for layout in layouts]
        first = 1 + np.cumsum([0, *nodes[:-1]], dtype=np.intp)
        self.object: Rows = first[self.owner] + np.concatenate(
            [
                none,
                *(
                    layout.model.nodes.numbers[layout.node]
                    for layout in layouts
                ),
            ]
        )
        self.local_bounds: Array = np.concatenate(
            [np.empty((0, 2, 3)), *(layout.bounds for layout in layouts)]
        )
        self.levels: DetailLevels | None = None
        if any(layout.levels is not None for layout in layouts):
            from moka.scene.level_of_detail import joined_levels

            starts = np.searchsorted(self.owner, np.arange(len(layouts)))
            self.levels = joined_levels(
                zip(
                    (layout.levels for layout in layouts),
                    starts.tolist(),
                    strict=True,
                )
            )
        self.points: NDArray[np.bool_] = np.array(
            [each.topology is Topology.POINTS for each in self.primitives],
            np.bool_,
        )[self.primitive]
        self.total = len(self.row)
        self.world_bounds: Array = np.zeros_like(self.local_bounds)
        self.boxes = pack_boxes(self.world_bounds)
        self.mirrored: NDArray[np.bool_] = np.zeros(len(self.row), np.bool_)
        self._version = -1  # Of the transforms; none is that old.
        self.poses: Poses | None = None
        if any(layout.deforms for layout in layouts):
            self.poses = _poses(self, placed, weights)

    def __len__(self) -> int:
        return len(self.row)

    def refresh(self, tree: TransformTree) -> None:
        """Follow what moved in ``tree``, and poses, since the last call."""
        still = self.poses is None or not self.poses.morphs.has_changed
        if self._version == tree.version and still:
            return
        touched = np.zeros(len(tree.world), np.bool_)
        touched[tree.changed_since(self._version)] = True
        self._version = tree.version
        self.place_boxes(np.flatnonzero(touched[self.row]), tree.world)
        if self.poses is not None:
            self.poses.refresh(self, tree.world, touched)

    def place_boxes(self, draws: Rows, matrices: Array) -> None:
        """Boxes and winding of ``draws`` as their rows of ``matrices`` are."""
        world = matrices[self.row[draws]]
        # What overflows is not finite, and culling keeps that.
        with np.errstate(over="ignore", invalid="ignore"):
            bounds = transform_bounds(world, self.local_bounds[draws])
            self.mirrored[draws] = is_mirrored(world)
        self.set_bounds(draws, bounds)

    def set_bounds(self, draws: Rows, bounds: Array) -> None:
        """Give ``draws`` (N,) their boxes (N, 2, 3) in the world."""
        self.world_bounds[draws] = bounds
        self.boxes[:, draws] = pack_boxes(bounds)

    def only(self, kept: NDArray[np.bool_]) -> "Drawables":
        """These draws without those that are not ``kept`` (D,).

        Levels of detail are settled: what is kept is shown.
        """
        made = copy(self)
        made.levels = None
        for name in _COLUMNS:
            setattr(made, name, getattr(self, name)[kept])
        made.boxes = self.boxes[:, kept]
        used, made.primitive = np.unique(made.primitive, return_inverse=True)
        made.primitives = [self.primitives[index] for index in used.tolist()]
        if self.poses is not None:
            made.poses = self.poses.only(kept, made)
            made._version = -1  # So that these follow everything once.
        return made

    def bounds(self, shown: NDArray[np.bool_]) -> Array | None:
        """The world box (2, 3) of the draws ``shown`` (D,), None of none."""
        return union_bounds(self.world_bounds[shown]) if shown.any() else None


def _poses(
    drawables: Drawables,
    placed: Sequence[tuple[ModelLayout, Rows]],
    weights: Sequence["MorphWeights | None"],
) -> "Poses":
    from moka.scene.poses import PosedModel, Poses

    return Poses(
        drawables,
        [
            PosedModel(layout.model.skins, rows, each)
            for (layout, rows), each in zip(placed, weights, strict=True)
        ],
        np.concatenate([layout.node for layout, _ in placed]),
        np.concatenate([layout.skin for layout, _ in placed]),
    )


def _pairs(
    instances: tuple[NDArray[np.int32], NDArray[np.int32]],
) -> list[tuple[int, int]]:
    """Nodes and what they place as pairs of Python's numbers."""
    nodes, placed = instances
    return list(zip(nodes.tolist(), placed.tolist(), strict=True))


def _joined(
    layouts: Sequence[ModelLayout],
) -> tuple[list[Primitive], dict[int, Rows]]:
    """Every primitive once; for each layout's id, where those it draws are."""
    position_of: dict[int, int] = {}
    primitives: list[Primitive] = []
    drawn: dict[int, Rows] = {}
    for layout in layouts:
        if id(layout) in drawn:
            continue
        for primitive in layout.primitives:
            if id(primitive) not in position_of:
                position_of[id(primitive)] = len(primitives)
                primitives.append(primitive)
        positions = [position_of[id(each)] for each in layout.primitives]
        drawn[id(layout)] = np.array(positions, np.intp)[layout.primitive]
    return primitives, drawn
