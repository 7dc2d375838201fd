"""Arrays of draws and of their instances, cut and put together."""

import numpy as np
from numpy.typing import NDArray

from moka.commands.draws import DRAW, INSTANCE, Draws, Instances

__all__ = ["concatenate", "gather_instances", "join", "part", "take"]


def _words(rows: NDArray[np.void]) -> NDArray[np.uint64]:
    """The same memory as (N, words of a row): copied in one go, ten times
    faster than NumPy copies structures field by field.
    """
    rows = np.ascontiguousarray(rows)
    return rows.view(np.uint64).reshape(len(rows), rows.itemsize // 8)


def concatenate(
    arrays: list[NDArray[np.void]], dtype: np.dtype[np.void]
) -> NDArray[np.void]:
    """Arrays of ``dtype`` one after the other; a single one as it is."""
    if len(arrays) == 1:
        return arrays[0]
    if not arrays:
        return np.zeros(0, dtype)
    return np.concatenate([_words(rows) for rows in arrays]).view(dtype)[:, 0]


def take(rows: NDArray[np.void], order: NDArray[np.int64]) -> NDArray[np.void]:
    """The rows at ``order`` (N,), copied."""
    return _words(rows).take(order, axis=0).view(rows.dtype)[:, 0]


def part(
    piece: tuple[Draws, Instances], start: int, stop: int
) -> tuple[Draws, Instances]:
    """Rows ``start`` to ``stop`` of a piece, and their instances.

    A piece is draws and the instances that they count, in their order.
    """
    rows = piece[0][start:stop]
    if not len(rows):
        return rows, piece[1][:0]
    first, last = int(rows[0]["first_instance"]), rows[-1]
    end = int(last["first_instance"]) + int(last["instance_count"])
    return rows, piece[1][first:end]


def join(
    pieces: list[tuple[Draws, Instances]],
) -> tuple[Draws, Instances]:
    """Draws one after the other, and their instances in their order."""
    # A copy, since the column is written below.
    draws = concatenate(
        [np.empty(0, DRAW), *(rows for rows, _ in pieces)], DRAW
    )
    counts = draws["instance_count"]
    draws["first_instance"] = np.cumsum(counts) - counts
    return draws, concatenate([used for _, used in pieces], INSTANCE)


def gather_instances(draws: Draws, instances: Instances) -> Instances:
    """Instances in draw order; rewrites ``first_instance`` of ``draws``."""
    counts = draws["instance_count"].astype(np.int64)
    total = int(counts.sum())
    starts = np.cumsum(counts) - counts
    if (counts == 1).all():
        # A copy, since the column is written below.
        rows = draws["first_instance"].astype(np.int64)
    else:
        shift = draws["first_instance"].astype(np.int64) - starts
        rows = np.arange(total) + np.repeat(shift, counts)
    draws["first_instance"] = starts
    return take(instances, rows)
