"""Which corners of a triangle mesh belong together.

A mesh of T triangles has 3 T corners; corner 3 t + i is corner i of triangle
t, and half-edge 3 t + i runs from it to the triangle's next corner. All
functions work on whole arrays of integers.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Integers", "connected_components", "corner_links", "equal_rows"]

Integers = NDArray[np.int64]

# Odd and without pattern: that of MMIX's generator (Knuth).
_MULTIPLIER = np.uint64(6364136223846793005)


def equal_rows(rows: NDArray[np.float32]) -> Integers:
    """A number (N,) for each of ``rows`` (N, C), the same for equal rows."""
    # One sort by a sum of all bits; -0 must have those of 0.
    bits = np.ascontiguousarray(rows + np.float32(0)).view(np.uint32)
    code = np.zeros(len(rows), np.uint64)
    for column in bits.T:
        code = (code ^ column) * _MULTIPLIER
        code ^= code >> np.uint64(29)
    order = np.argsort(code, kind="stable")
    ordered = rows[order]
    differs = (ordered[1:] != ordered[:-1]).any(axis=1)
    if (differs & (code[order][1:] == code[order][:-1])).any():
        # Different rows of one code may stand between equal ones.
        order = np.lexsort(rows.T)
        differs = (rows[order][1:] != rows[order][:-1]).any(axis=1)
    numbers = np.empty(len(rows), np.int64)
    numbers[order] = np.concatenate([[0], np.cumsum(differs)])
    return numbers


def corner_links(vertices: Integers, alive: NDArray[np.bool_]) -> Integers:
    """For each corner the next one around its vertex, -1 if there is none.

    ``vertices`` (3 T,) names the vertex of each corner, ``alive`` (T,) the
    triangles that take part. The next corner is that of the triangle which
    shares the half-edge that starts here and walks it the other way. Where
    more than two triangles share an edge, those that walk it one way are
    paired in order with those that walk it the other way.
    """
    edges = np.flatnonzero(np.repeat(alive, 3))
    start, end = vertices[edges], vertices[_next_in_triangle(edges)]
    forward = start < end
    low, high = np.minimum(start, end), np.maximum(start, end)
    key = low * (vertices.max(initial=0) + 1) + high
    # The how many-eth of its edge and direction each half-edge is.
    order = np.argsort(2 * key + forward, kind="stable")
    key, forward, edges = key[order], forward[order], edges[order]
    new_run = np.ones(len(edges), bool)
    new_run[1:] = (np.diff(key) != 0) | (forward[1:] != forward[:-1])
    places = np.arange(len(edges))
    rank = places - np.maximum.accumulate(np.where(new_run, places, 0))
    if rank.any():
        # Then equal ranks of the two directions come next to each other.
        order = np.lexsort((forward, rank, key))
        key, rank, edges = key[order], rank[order], edges[order]
    pair = np.flatnonzero((np.diff(key) == 0) & (np.diff(rank) == 0))
    first, second = edges[pair], edges[pair + 1]
    links = np.full(len(vertices), -1, np.int64)
    links[first] = _next_in_triangle(second)
    links[second] = _next_in_triangle(first)
    return links


def connected_components(
    count: int, first: Integers, second: Integers
) -> Integers:
    """The least member (N,) of the component of each of ``count`` things.

    ``first`` and ``second`` are the ends of the links. Labels are lowered
    along links and then jump to their labels' labels until nothing changes,
    which takes about log(N) rounds (Shiloach and Vishkin 1982).
    """
    labels = np.arange(count)
    while True:
        lowest = np.minimum(labels[first], labels[second])
        lowered = labels.copy()
        # The labels' owners are lowered too, so that whole trees move.
        for end in (first, second):
            np.minimum.at(lowered, labels[end], lowest)
            np.minimum.at(lowered, end, lowest)
        while (lowered[lowered] != lowered).any():
            lowered = lowered[lowered]
        if (lowered == labels).all():
            return labels
        labels = lowered


def _next_in_triangle(corners: Integers) -> Integers:
    return corners + np.where(corners % 3 == 2, -2, 1)
