"""Which rows are alive and which row is whose parent.

The shape of a scene without its matrices. Children and levels are found for
all rows at once when they are next needed after a change.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from moka.core.errors import OptionError

__all__ = ["NO_ROWS", "Forest", "Rows"]

Rows = NDArray[np.intp]

NO_ROWS: Rows = np.empty(0, np.intp)


class Forest:
    """Rows with parents; a row keeps its number until it is freed."""

    def __init__(self) -> None:
        self._size = 0
        self._free: list[int] = []
        self._parent = np.empty(16, np.intp)
        self._alive = np.zeros(16, np.bool_)
        self._linked = True
        # Children of row r: _children[_start[r] :][: _count[r]].
        self._children = NO_ROWS
        self._start = NO_ROWS
        self._count = NO_ROWS
        self._level = NO_ROWS

    def __len__(self) -> int:
        """How many rows are alive."""
        return self._size - len(self._free)

    @property
    def size(self) -> int:
        """How many rows there are, freed ones included."""
        return self._size

    @property
    def parents(self) -> Rows:
        """Parent rows (size,), -1 for roots; only for reading."""
        return self._parent[: self._size]

    @property
    def alive(self) -> NDArray[np.bool_]:
        """Which rows (size,) are in use; only for reading."""
        return self._alive[: self._size]

    @property
    def levels(self) -> Rows:
        """Number of ancestors (size,) of each row; only for reading."""
        self._link()
        return self._level

    def parent(self, row: int) -> int:
        """The parent of ``row``, -1 for a root."""
        return int(self._parent[row])

    def insert(self, inside: Rows, parent: int = -1) -> Rows:
        """New rows (N,) in the order of the nodes that they are for.

        ``inside`` (N,) holds each node's parent as a position among the new
        nodes; where it is -1 the node comes below the old row ``parent``.
        """
        count = len(inside)
        reused = [self._free.pop() for _ in range(min(count, len(self._free)))]
        first = self._size
        self._size += count - len(reused)
        missing = self._size - len(self._parent)
        if missing > 0:
            more = max(missing, len(self._parent))
            self._parent = np.append(self._parent, np.empty(more, np.intp))
            self._alive = np.append(self._alive, np.zeros(more, np.bool_))
        rows = np.array([*reused, *range(first, self._size)], np.intp)
        self._parent[rows] = np.where(inside < 0, parent, rows[inside])
        self._alive[rows] = True
        self._linked = False
        return rows

    def set_parent(self, row: int, parent: int) -> None:
        """Put ``row`` with all below it under ``parent``, -1 for none.

        Raises OptionError if ``row`` would become its own ancestor.
        """
        if row in self.line(parent):
            raise OptionError("transform: cannot be its own ancestor")
        self._parent[row] = parent
        self._linked = False

    def orphans(self, rows: Rows) -> Rows:
        """Rows that lose their parent, but not themselves, with ``rows``."""
        removed = np.zeros(self._size + 1, np.bool_)  # A last one for -1.
        removed[rows] = True
        return np.flatnonzero(removed[self.parents] & ~removed[:-1])

    def free(self, rows: Rows) -> None:
        """Give back ``rows``, which must not have children elsewhere."""
        self._alive[rows] = False
        self._parent[rows] = -1
        self._free.extend(rows.tolist())
        self._linked = False

    def line(self, row: int) -> Iterator[int]:
        """``row`` and its ancestors, the root last; nothing for -1."""
        while row >= 0:
            yield row
            row = int(self._parent[row])

    def subtree(self, row: int) -> Rows:
        """``row`` and all rows below it, parents before children."""
        levels = [np.array([row], np.intp)]
        while levels[-1].size:
            levels.append(self.children_of(levels[-1]))
        return np.concatenate(levels)

    def children_of(self, rows: Rows) -> Rows:
        """All direct children of ``rows``, in the order of their parents."""
        self._link()
        counts = self._count[rows]
        ends = np.cumsum(counts)
        first = self._start[rows] - ends + counts
        within = np.arange(ends[-1] if ends.size else 0)
        return np.asarray(self._children[np.repeat(first, counts) + within])

    def _link(self) -> None:
        """Sort the rows by parent and find their levels."""
        if self._linked:
            return
        self._linked = True
        self._children = np.argsort(self.parents, kind="stable")
        count = np.bincount(self.parents + 1, minlength=self._size + 1)
        start = np.cumsum(count) - count
        self._count, self._start = count[1:], start[1:]
        self._level = np.zeros(self._size, np.intp)
        level, rows = 0, self._children[: count[0]]  # The roots.
        while rows.size:
            self._level[rows] = level
            level, rows = level + 1, self.children_of(rows)
