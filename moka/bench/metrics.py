"""How far a picture is from a reference: RMSE, relative RMSE, PSNR.

All are computed in float64 over arrays of the same shape, whatever their
axes mean; the perceptual metric is in :mod:`moka.bench.flip`. The reference
is always the first argument.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["psnr", "relative_rmse", "rmse"]


def rmse(reference: ArrayLike, test: ArrayLike) -> float:
    """The root of the mean squared difference, in the unit of the values.

    Raises ValueError where the shapes differ or nothing is to be compared.
    """
    first, second = _pair(reference, test)
    return _root_mean_square(second - first)


def relative_rmse(reference: ArrayLike, test: ArrayLike) -> float:
    """:func:`rmse` over the root mean square of the reference.

    A ratio of two sums, not a sum of ratios: dark values, whose own relative
    error means little, neither dominate it nor need an epsilon. Infinite
    where only the reference is zero throughout, zero where both are.
    """
    first, second = _pair(reference, test)
    error = _root_mean_square(second - first)
    if error == 0.0:
        return 0.0
    scale = _root_mean_square(first)
    return error / scale if scale > 0.0 else math.inf


def psnr(reference: ArrayLike, test: ArrayLike, peak: float = 1.0) -> float:
    """Peak signal-to-noise ratio in decibel: 20 log10(peak / RMSE).

    ``peak`` is the largest value that the signal can have: 1 for encoded
    pictures. Infinite for equal pictures, and minus infinity where ``peak``
    is 0 and the pictures differ.
    """
    error = rmse(reference, test)
    if error == 0.0:
        return math.inf
    return 20.0 * math.log10(peak / error) if peak > 0.0 else -math.inf


def _pair(
    reference: ArrayLike, test: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    first = np.asarray(reference, np.float64)
    second = np.asarray(test, np.float64)
    if first.shape != second.shape:
        raise ValueError(f"shapes {first.shape} and {second.shape} differ")
    if not first.size:
        raise ValueError("nothing to compare")
    return first, second


def _root_mean_square(values: NDArray[np.float64]) -> float:
    # Scaled by the largest value, so that no square overflows.
    largest = float(np.abs(values).max())
    if largest == 0.0 or not math.isfinite(largest):
        return largest
    return largest * math.sqrt(float(np.mean(np.square(values / largest))))
