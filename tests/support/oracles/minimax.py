"""The polynomials that shaders have in place of functions."""

from collections.abc import Callable, Sequence

import numpy as np

from tests.support.oracles.directions import Array

__all__ = ["minimax"]


def minimax(
    function: Callable[[Array], Array],
    powers: Sequence[int],
    low: float,
    high: float,
) -> tuple[Array, float]:
    """Coefficients (N,) of ``powers`` (N) with the smallest largest error.

    Remez 1934: between ``low`` and ``high`` the error of the best polynomial
    is equally large at N + 1 places, with signs in turn. Returns that error
    too, which no other coefficients go below.
    """
    count = len(powers) + 1
    turn = (1.0 - np.cos(np.linspace(0.0, np.pi, 100_001))) / 2.0
    grid = low + (high - low) * turn
    rows, values = grid[:, None] ** np.array(powers), function(grid)
    places = np.linspace(0, len(grid) - 1, count + 1).astype(int)[1:]
    for _ in range(20):
        signs = (-1.0) ** np.arange(count)
        system = np.column_stack((rows[places], signs))
        *solved, level = np.linalg.solve(system, values[places])
        error = rows @ solved - values
        changes = np.flatnonzero(np.diff(np.signbit(error))) + 1
        lobes = np.split(np.arange(len(grid)), changes)
        peaks = [lobe[np.abs(error[lobe]).argmax()] for lobe in lobes]
        # One of the ends may be a lobe too many.
        while len(peaks) > count:
            first, last = np.abs(error[[peaks[0], peaks[-1]]])
            peaks.pop(0 if first < last else -1)
        places = np.array(peaks)
    assert np.abs(error).max() < 1.001 * abs(level)
    return np.array(solved), float(np.abs(error).max())
