"""Which rows of a tree of nodes are to be seen, fast for any number of them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["TreeRows"]


class TreeRows:
    """A forest of nodes, of which some are open.

    ``parents`` (N,) are the rows of the parents, -1 for roots. ``depth``
    (N,) counts from the root. What is seen is listed anew only after it has
    changed, so that a frame costs what it shows.
    """

    def __init__(self, parents: ArrayLike, names: Sequence[str]) -> None:
        self._parents = np.asarray(parents, np.intp)
        self._names = names
        count = len(self._parents)
        children: list[list[int]] = [[] for _ in range(count)]
        roots: list[int] = []
        for row, parent in enumerate(self._parents.tolist()):
            (roots if parent < 0 else children[parent]).append(row)
        # Depth first: a subtree is a run of the order.
        order: list[int] = []
        self.depth: NDArray[np.intp] = np.zeros(count, np.intp)
        waiting = roots[::-1]
        while waiting:
            row = waiting.pop()
            order.append(row)
            waiting.extend(reversed(children[row]))
            if children[row]:
                self.depth[children[row]] = self.depth[row] + 1
        self._order = order
        size = np.ones(count, np.intp)
        for row in reversed(order):
            if (parent := int(self._parents[row])) >= 0:
                size[parent] += size[row]
        self._size: list[int] = size.tolist()
        self._open: set[int] = set()
        self._seen: list[int] | None = None
        self._search = ""

    def __len__(self) -> int:
        return len(self._order)

    def has_children(self, row: int) -> bool:
        """Whether a node can be opened."""
        return self._size[row] > 1

    def is_open(self, row: int) -> bool:
        """Whether what is below a node is shown."""
        return row in self._open

    def toggle(self, row: int) -> None:
        """Open what is closed, and the other way round."""
        self._open ^= {row}
        self._seen = None

    def reveal(self, row: int) -> None:
        """Open all that a node lies in."""
        parent = int(self._parents[row])
        while parent >= 0:
            self._open.add(parent)
            parent = int(self._parents[parent])
        self._seen = None

    @property
    def search(self) -> str:
        """What names are to contain, in letters of either case."""
        return self._search

    @search.setter
    def search(self, text: str) -> None:
        if text != self._search:
            self._search = text
            self._seen = None

    @property
    def seen(self) -> list[int]:
        """The rows in the order in which they are seen.

        Those whose names match where there is a search, open or not.
        """
        if self._seen is None:
            self._seen = self._found() if self._search else self._opened()
        return self._seen

    def _found(self) -> list[int]:
        text = self._search.casefold()
        names = self._names
        return [row for row in self._order if text in names[row].casefold()]

    def _opened(self) -> list[int]:
        seen = []
        place, count = 0, len(self._order)
        while place < count:
            row = self._order[place]
            seen.append(row)
            place += 1 if row in self._open else self._size[row]
        return seen
