"""Which level of detail each object is drawn at, for all of them at once.

A draw belongs to the levels that it lies below: nodes that stand for one
another, and materials that do. It is shown where every one of them is the
level that its group shows, which follows from the part of the picture that
the group covers.

Source: MSFT_lod; what it calls screen coverage is here the share of the
picture that the bounding sphere covers, which turning the camera or the
object does not change.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.maths import Array
from moka.model.lods import NodeLevels
from moka.model.mesh import Primitive
from moka.model.nodes import NodeTree, ancestors
from moka.scene.camera import Camera
from moka.scene.forest import Rows

__all__ = [
    "DetailLevels",
    "joined_levels",
    "material_levels",
    "node_levels",
    "screen_coverage",
]


class DetailLevels:
    """C memberships of draws in levels of G groups.

    ``draw`` (C,) is a draw, ``group`` (C,) the group and ``level`` (C,) the
    level of it that the draw belongs to; ``limits`` (G, L) are the least
    coverages of the levels, NaN where a group has fewer than L.
    """

    def __init__(
        self, draw: Rows, group: Rows, level: Rows, limits: Array
    ) -> None:
        order = np.argsort(group, kind="stable")
        self.draw, self.group, self.level = (
            draw[order],
            group[order],
            level[order],
        )
        # Groups without draws have nothing to decide.
        used, self._start, self._group = np.unique(
            self.group, return_index=True, return_inverse=True
        )
        self.limits = limits
        self._limits = limits[used]

    def shown(
        self, world_bounds: Array, camera: Camera, aspect: float
    ) -> NDArray[np.bool_]:
        """Which draws (D,) of boxes (D, 2, 3) are of the level to be seen.

        A group is as large as all its draws together, whatever is shown, so
        that its level does not depend on its level.
        """
        boxes = world_bounds[self.draw]
        covered = screen_coverage(
            np.minimum.reduceat(boxes[:, 0], self._start),
            np.maximum.reduceat(boxes[:, 1], self._start),
            camera,
            aspect,
        )
        reached = covered[:, None] >= self._limits
        level = np.where(reached.any(axis=1), reached.argmax(axis=1), -1)
        shown = np.ones(len(world_bounds), np.bool_)
        shown[self.draw[level[self._group] != self.level]] = False
        return shown


def joined_levels(
    parts: Iterable[tuple[DetailLevels | None, int]],
) -> DetailLevels | None:
    """Levels together, each with the number at which its draws begin."""
    some = [(each, first) for each, first in parts if each is not None]
    if not some:
        return None
    width = max(each.limits.shape[1] for each, _ in some)
    counts = [len(each.limits) for each, _ in some]
    first_group = np.cumsum([0, *counts]).tolist()
    return DetailLevels(
        np.concatenate([each.draw + first for each, first in some]),
        np.concatenate(
            [
                each.group + first
                for (each, _), first in zip(some, first_group, strict=False)
            ]
        ),
        np.concatenate([each.level for each, _ in some]),
        np.concatenate([_padded(each.limits, width) for each, _ in some]),
    )


def screen_coverage(
    least: Array, greatest: Array, camera: Camera, aspect: float
) -> Array:
    """The shares (N,) of a picture that the spheres around boxes cover.

    Boxes have the corners ``least`` and ``greatest`` (N, 3) in the world. 1
    at most, also for what the camera is inside of or has no finite size. In
    perspective a sphere is seen under the angle arcsin(radius / distance),
    wherever in the picture it is.
    """
    projection = camera.projection_matrix(aspect)
    # Half the picture's width and height in the plane at distance 1.
    scale = projection[0, 0] * projection[1, 1]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        square = np.sum(np.square(0.5 * (greatest - least)), axis=1)
        if projection[3, 3] == 0:
            centre = 0.5 * (least + greatest)
            distance = np.sum(np.square(centre - camera.position), axis=1)
            square = np.where(
                distance > square, square / (distance - square), np.inf
            )
        # An ellipse of these half axes, in a picture of 2 by 2.
        covered = 0.25 * np.pi * scale * square
    return np.where(covered < 1, covered, 1.0)


def node_levels(tree: NodeTree, node: Rows) -> DetailLevels | None:
    """The levels that draws at the rows ``node`` (D,) of a tree lie below."""
    levels = tree.levels
    if levels is None:
        return None
    entry = np.full(len(tree), -1, np.intp)
    entry[levels.node] = np.arange(len(levels.node))
    # The nearest level at or above each node, or a root that is none.
    nearest, _ = ancestors(np.where(entry < 0, tree.parents, np.int32(-1)))
    draws = np.arange(len(node))
    place: NDArray[Any] = node
    found_draws, found_entries = [], []
    while draws.size:
        place = nearest[place]
        inside = entry[place] >= 0
        draws, place = draws[inside], place[inside]
        found_draws.append(draws)
        found_entries.append(entry[place])
        above = tree.parents[place]
        draws, place = draws[above >= 0], above[above >= 0]
    entries = np.concatenate(found_entries)
    return DetailLevels(
        np.concatenate(found_draws),
        levels.group[entries].astype(np.intp),
        levels.level[entries].astype(np.intp),
        _limits(levels),
    )


def _limits(levels: NodeLevels) -> Array:
    shape = int(levels.group.max()) + 1, int(levels.level.max()) + 1
    limits = np.full(shape, np.nan)
    limits[levels.group, levels.level] = levels.limit
    return limits


def material_levels(
    primitives: list[Primitive], primitive: Rows
) -> tuple[list[Primitive], Rows, Rows, DetailLevels | None]:
    """A draw for each level of the material of each of D draws.

    Takes the primitives and which of them each draw (D,) shows. Returns
    these for E draws, the number (E,) of the draw that each was made from,
    and the levels; E is D and the levels are None where no material has any.
    """
    draws = np.arange(len(primitive))
    if not any(
        each.material is not None and each.material.coarser
        for each in primitives
    ):
        return primitives, primitive, draws, None
    made = [_with_levels(each) for each in primitives]
    count = np.array([len(each) for each in made])
    first = np.cumsum(count) - count
    copies = count[primitive]
    draws = np.repeat(draws, copies)
    level = np.arange(len(draws)) - np.repeat(
        np.cumsum(copies) - copies, copies
    )
    limits = np.full((len(primitive), count.max()), np.nan)
    for index, each in enumerate(primitives):
        if each.material is not None and each.material.coarser:
            limits[primitive == index, : count[index]] = each.material.limits
    many = np.flatnonzero(copies[draws] > 1)
    return (
        [copy for copies_ in made for copy in copies_],
        first[primitive[draws]] + level,
        draws,
        DetailLevels(many, draws[many], level[many], limits),
    )


def _with_levels(primitive: Primitive) -> list[Primitive]:
    material = primitive.material
    coarser = () if material is None else material.coarser
    return [primitive, *(primitive.shared_with(each) for each in coarser)]


def _padded(limits: Array, width: int) -> Array:
    missing = width - limits.shape[1]
    return np.pad(limits, ((0, 0), (0, missing)), constant_values=np.nan)
