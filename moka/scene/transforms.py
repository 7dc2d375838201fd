"""All transforms of a scene as arrays: local and world matrices.

What reads world matrices (bounds, uploads) asks
:meth:`TransformTree.changed_since` for the rows that moved since it last
looked, so that a still scene costs nothing per node.
"""

from collections.abc import Iterator
from typing import Protocol, TypeVar
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError
from moka.core.maths import Array, invert_affine
from moka.scene.forest import NO_ROWS, Forest, Rows

__all__ = ["RowHandle", "Rows", "TransformTree", "check_affine"]

_Number = TypeVar("_Number", bound=np.generic)

_ALONE: Rows = np.array([-1])


class RowHandle(Protocol):
    """What stands for one row and must know when the row moves."""

    def row_moved(self, tree: "TransformTree | None", row: int) -> None:
        """The row is now ``row`` of ``tree``; None if it was removed."""


class TransformTree:
    """Local and world matrices of a forest of nodes, one row per node.

    Matrices are float64 (4, 4), indexed [row, column], local to parent and
    local to world. Rows are numbered in no order; freed ones are used again.
    ``version`` counts the updates that changed a world matrix,
    ``hidden_version`` what may have shown or hidden a row. ``handles``
    are the live single-row views, one per row. A ``fixed`` tree is a
    scene's: its rows do not move to other trees.
    """

    def __init__(self, *, fixed: bool = False) -> None:
        self.version = 0
        self.hidden_version = 0
        self.fixed = fixed
        self.handles: WeakValueDictionary[int, RowHandle] = (
            WeakValueDictionary()
        )
        self._forest = Forest()
        self._stale = False  # Whether anything is dirty.
        self._local: Array = np.empty((0, 4, 4))
        self._world: Array = np.empty((0, 4, 4))
        self._dirty: NDArray[np.bool_] = np.empty(0, np.bool_)
        self._changed: NDArray[np.int64] = np.empty(0, np.int64)
        self._edits: NDArray[np.int64] = np.empty(0, np.int64)
        # Only own marks; few scenes have any.
        self._hidden: NDArray[np.bool_] = np.empty(0, np.bool_)
        self._all_hidden: NDArray[np.bool_] | None = None

    def __len__(self) -> int:
        """How many rows are alive."""
        return len(self._forest)

    @property
    def local(self) -> Array:
        """Local matrices (R, 4, 4), freed rows included; only for reading."""
        return self._local[: self._forest.size]

    @property
    def world(self) -> Array:
        """World matrices (R, 4, 4) of the last update; only for reading."""
        return self._world[: self._forest.size]

    @property
    def parents(self) -> Rows:
        """Parent rows (R,), -1 for roots; only for reading."""
        return self._forest.parents

    @property
    def alive(self) -> NDArray[np.bool_]:
        """Which rows (R,) are in use; only for reading."""
        return self._forest.alive

    def add(self, local: ArrayLike | None = None, parent: int = -1) -> int:
        """A new row below row ``parent``, -1 for none; the identity if None.

        Raises OptionError if ``local`` is not an affine matrix.
        """
        matrix = np.eye(4) if local is None else check_affine(local)
        return int(self._insert(matrix[None], _ALONE, parent)[0])

    def add_many(
        self, local: ArrayLike, parents: ArrayLike, parent: int = -1
    ) -> Rows:
        """New rows (N,) for local matrices (N, 4, 4), in their order.

        ``parents`` (N,) are positions among the new nodes, each before its
        children; -1 puts a node below row ``parent``. Raises OptionError if
        a matrix is not affine, ValueError if a parent comes after its child.
        """
        parents = np.asarray(parents, np.intp)
        if (parents >= np.arange(len(parents))).any():
            raise ValueError("a parent must come before its children")
        local = check_affine(local, parents.shape)
        return self._insert(local, parents, parent)

    def set_local(self, rows: int | Rows, local: ArrayLike) -> None:
        """Replace the local matrices (..., 4, 4) of ``rows`` (...).

        Raises OptionError if a matrix is not affine.
        """
        self._local[rows] = check_affine(local, np.shape(rows))
        self._edits[rows] += 1
        self._dirty[rows] = True
        self._stale = True

    def is_visible(self, row: int) -> bool:
        """Whether ``row`` itself is not marked as hidden."""
        return not self._hidden[row]

    def set_visible(self, rows: int | Rows, visible: ArrayLike) -> None:
        """Mark ``rows`` (...) as visible (...) or, with all below, hidden."""
        if (self._hidden[rows] == visible).any():
            self._hidden[rows] = np.logical_not(visible)
            self._all_hidden = None
            self.hidden_version += 1

    def hidden(self) -> NDArray[np.bool_]:
        """Which rows (R,) are hidden or below one that is; read only.

        Source: KHR_node_visibility.
        """
        if self._all_hidden is None:
            hidden = self._hidden[: self._forest.size].copy()
            rows = np.flatnonzero(hidden)
            while rows.size:
                rows = self._forest.children_of(rows)
                hidden[rows] = True
            self._all_hidden = hidden
        return self._all_hidden

    def edits(self, row: int) -> int:
        """How often the local matrix of ``row`` was replaced."""
        return int(self._edits[row])

    def set_parent(self, row: int, parent: int) -> None:
        """Put ``row`` with all below it under ``parent``, -1 for none.

        The local matrix stays. Raises OptionError if ``row`` would become
        its own ancestor.
        """
        self._forest.set_parent(row, parent)
        self._forget_hidden()
        self._dirty[row] = True
        self._stale = True

    def world_of(self, row: int) -> Array:
        """The world matrix (4, 4) of ``row`` as it is now; -1 is the world."""
        matrix = np.eye(4)
        for ancestor in self._forest.line(row):
            matrix = self._local[ancestor] @ matrix
        return matrix

    def relative_to(self, row: int, world: Array) -> Array:
        """``world`` (4, 4) as seen from ``row``, -1 being the world itself.

        Raises OptionError if ``row`` or something above it has scale 0.
        """
        try:
            return invert_affine(self.world_of(row)) @ world
        except np.linalg.LinAlgError:
            raise OptionError(
                "transform: a parent has scale 0, so that nothing can be "
                "placed relative to it"
            ) from None

    def subtree(self, row: int) -> Rows:
        """``row`` and all rows below it, parents before children."""
        return self._forest.subtree(row)

    def remove(self, rows: Rows) -> None:
        """Free ``rows``; their handles say so when they are used.

        Children that are not among them become roots and stay where they
        are in the world.
        """
        for orphan in self._forest.orphans(rows).tolist():
            self.set_local(orphan, self.world_of(orphan))
            self.set_parent(orphan, -1)
        for row in rows.tolist():
            handle = self.handles.pop(row, None)
            if handle is not None:
                handle.row_moved(None, -1)
        self._dirty[rows] = False
        self._hidden[rows] = False
        self._forest.free(rows)
        self._forget_hidden()

    def absorb(self, other: "TransformTree") -> None:
        """Take over all rows of ``other``, whose handles then point here.

        Nothing may use ``other`` after that. Raises OptionError if it
        belongs to a scene.
        """
        if other.fixed:
            raise OptionError(
                "transform: belongs to another scene; remove it there first"
            )
        old = np.flatnonzero(other.alive)
        position = np.cumsum(other.alive) - 1
        parents = other.parents[old]
        inside = np.where(parents < 0, -1, position[parents])
        new = self._insert(other.local[old], inside, -1)
        self._hidden[new] = other._hidden[old]
        for row, handle in other.handles.items():
            moved = int(new[position[row]])
            self.handles[moved] = handle
            handle.row_moved(self, moved)

    def changed_since(self, version: int) -> Rows:
        """Rows whose world matrix changed after update ``version``."""
        if version >= self.version:
            return NO_ROWS
        return np.flatnonzero(self._changed[: self._forest.size] > version)

    def update(self) -> Rows:
        """Bring all world matrices up to date; the rows that changed.

        Only what was touched and what is below it is computed, one level of
        the forest at a time. Costs nothing when nothing was touched.
        """
        if not self._stale:
            return NO_ROWS
        self._stale = False
        dirty = np.flatnonzero(self._dirty[: self._forest.size])
        if not dirty.size:
            return NO_ROWS
        rows = np.concatenate(list(self._recompute(dirty)))
        self._dirty[dirty] = False
        self.version += 1
        self._changed[rows] = self.version
        return rows

    def _recompute(self, dirty: Rows) -> Iterator[Rows]:
        """Compute ``dirty`` rows and all below, level by level."""
        levels = self._forest.levels[dirty]
        order = np.argsort(levels, kind="stable")
        dirty, levels = dirty[order], levels[order]
        first, last = int(levels[0]), int(levels[-1])
        ends = np.searchsorted(levels, np.arange(first, last + 2))
        rows = NO_ROWS
        level = first
        while level <= last or rows.size:
            rows = self._forest.children_of(rows)
            if level <= last:
                own = dirty[ends[level - first] : ends[level - first + 1]]
                rows = np.concatenate([rows[~self._dirty[rows]], own])
            local = self._local.take(rows, axis=0)
            if level > 0:
                above = self._world.take(self.parents[rows], axis=0)
                # Absurd scales overflow; culling keeps what is not finite.
                with np.errstate(over="ignore", invalid="ignore"):
                    local = above @ local
            self._world[rows] = local
            yield rows
            level += 1

    def _insert(self, local: Array, inside: Rows, parent: int) -> Rows:
        """Rows for checked matrices; see :meth:`Forest.insert`."""
        rows = self._forest.insert(inside, parent)
        missing = self._forest.size - len(self._dirty)
        if missing > 0:
            more = max(missing, len(self._dirty))
            self._local = _extended(self._local, more)
            self._world = _extended(self._world, more)
            self._dirty = _extended(self._dirty, more)
            self._changed = _extended(self._changed, more)
            self._edits = _extended(self._edits, more)
            self._hidden = _extended(self._hidden, more)
        self._local[rows] = local
        self._edits[rows] += 1
        self._dirty[rows] = True
        self._stale = True
        self._forget_hidden()
        return rows

    def _forget_hidden(self) -> None:
        """What is below what has changed; without marks that is nothing."""
        self._all_hidden = None
        self.hidden_version += int(self._hidden.any())


def _extended(array: NDArray[_Number], more: int) -> NDArray[_Number]:
    """``array`` with ``more`` rows of zeros at its end."""
    rows = np.zeros((more, *array.shape[1:]), array.dtype)
    return np.concatenate([array, rows])


def check_affine(matrices: ArrayLike, leading: tuple[int, ...] = ()) -> Array:
    """``matrices`` as float64 of shape (*leading, 4, 4).

    Raises OptionError for another shape, NaN, infinity, or a last row other
    than 0, 0, 0, 1.
    """
    shape = (*leading, 4, 4)
    try:
        matrices = np.asarray(matrices, np.float64)
    except (TypeError, ValueError):
        raise OptionError(f"transform: expected {shape} numbers") from None
    if matrices.shape != shape:
        raise OptionError(
            f"transform: expected {shape} numbers, got {matrices.shape}"
        )
    if not np.isfinite(matrices).all():
        raise OptionError("transform: a matrix has NaN or infinite entries")
    if (np.abs(matrices[..., 3, :] - (0, 0, 0, 1)) > 1e-6).any():
        raise OptionError(
            "transform: the last row of a matrix must be 0, 0, 0, 1; "
            "a translation is in the last column"
        )
    return matrices
