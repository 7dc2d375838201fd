"""Levels of detail: nodes and materials that stand for one another.

The table of nodes is a row per level, so that a scene chooses the levels of
all its objects at once (:mod:`moka.scene.level_of_detail`).

Source: MSFT_lod.
"""

from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from moka.core.maths import Array
from moka.model.schema import Index, Material, Node, read_extension
from moka.model.source import GltfSource

__all__ = ["LEVELS", "NodeLevels", "read_levels", "read_node_levels"]

LEVELS = "MSFT_lod"


class _Extras(Struct):
    coverage: list[float] = msgspec.field(name="MSFT_screencoverage")


class _Levels(Struct):
    ids: Annotated[list[Index], Meta(min_length=1)]


class NodeLevels(Struct, eq=False):
    """K nodes that are levels of detail, each level of a group one.

    ``node`` (K,) is where the level stands, ``group`` (K,) its group and
    ``level`` (K,) its place there, 0 being the finest. ``limit`` (K,) is the
    least part of the picture at which it is shown, 0 for always. Rows of a
    group stand together, finest first.
    """

    node: NDArray[np.int32]
    group: NDArray[np.int32]
    level: NDArray[np.int32]
    limit: Array

    def at(self, rows: NDArray[np.int32]) -> "NodeLevels":
        """The same where node i of the file is in row ``rows[i]``."""
        return NodeLevels(rows[self.node], self.group, self.level, self.limit)


def read_levels(
    source: GltfSource,
    owner: Node | Material,
    path: str,
    kind: str,
    count: int,
) -> tuple[list[int], list[float]]:
    """Indices of the coarser levels of ``owner``, and the limits of all.

    ``kind`` is ``nodes`` or ``materials``, of which there are ``count``.
    Both lists are empty without the extension. Raises ModelError naming the
    JSON path of what is wrong.
    """
    extension = read_extension(owner, LEVELS, _Levels, source.where, path)
    if extension is None:
        return [], []
    for number, index in enumerate(extension.ids):
        place = f"{path}.extensions.{LEVELS}.ids[{number}]"
        source.check_index(place, index, kind, count)
    return extension.ids, _limits(owner.extras, 1 + len(extension.ids))


def _limits(extras: msgspec.Raw, count: int) -> list[float]:
    """The limits of ``count`` levels; ``extras`` may hold anything.

    A hint that is not a list of numbers is none: only the finest level is
    shown, as without any. What a list does not reach is shown down to 0.
    """
    given = [0.0]
    with suppress(msgspec.DecodeError):
        given = msgspec.json.decode(extras, type=_Extras).coverage
    limits = [min(max(value, 0.0), 1.0) for value in given[:count]]
    return limits + [0.0] * (count - len(limits))


def read_node_levels(
    source: GltfSource, nodes: Sequence[tuple[int, Node]]
) -> NodeLevels | None:
    """The levels among ``nodes``, in numbers of the file; None if none.

    Raises ModelError for levels that are not there, or a node that is a
    level of two groups.
    """
    node: list[int] = []
    group: list[int] = []
    level: list[int] = []
    limit: list[float] = []
    total = len(source.document.nodes)
    for index, owner in nodes:
        path = f"nodes[{index}]"
        coarser, limits = read_levels(source, owner, path, "nodes", total)
        if coarser:
            group += [group[-1] + 1 if group else 0] * len(limits)
            node += [index, *coarser]
            level += range(len(limits))
            limit += limits
    if not node:
        return None
    levels = NodeLevels(
        np.array(node, np.int32),
        np.array(group, np.int32),
        np.array(level, np.int32),
        np.array(limit),
    )
    unique, counts = np.unique(levels.node, return_counts=True)
    if (counts > 1).any():
        raise source.error(
            f"nodes[{unique[counts > 1][0]}]",
            f"is two levels of {LEVELS}",
        )
    return levels
