"""Grids of float32 inputs, and distances from the truth."""

import numpy as np
from numpy.typing import ArrayLike

from tests.support.oracles.directions import Array


def single(values: ArrayLike) -> Array:
    """As the shader gets them: rounded to float32."""
    return np.asarray(values, np.float32).astype(np.float64)


def grid(*axes: ArrayLike) -> tuple[Array, ...]:
    """All combinations of float32 values, one array for each axis."""
    return tuple(
        x.ravel() for x in np.meshgrid(*map(single, axes), indexing="ij")
    )


def relative(value: Array, expected: Array) -> float:
    return float(np.max(np.abs(value / expected - 1.0)))


def absolute(value: Array, expected: Array) -> float:
    return float(np.max(np.abs(value - expected)))
