"""Radiance painted at the centres of pixels, in float64."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Array", "black", "inside", "paint", "srgb_to_linear"]

Array = NDArray[Any]


def black(x: Array) -> Array:
    """Nothing, (H, W, 3)."""
    return np.zeros((*x.shape, 3))


def inside(
    x: Array, y: Array, centre: ArrayLike = (0, 0), half: ArrayLike = 1.0
) -> Array:
    """Whether places are in a square, or a rectangle of two halves."""
    across, up = np.broadcast_to(np.asarray(half, float), 2)
    cx, cy = np.asarray(centre, float)[:2]
    return np.asarray((abs(x - cx) < across) & (abs(y - cy) < up))


def paint(radiance: Array, where: Array, colour: ArrayLike) -> Array:
    """``colour``, one or (H, W, 3), where it is True; in place."""
    colours = np.broadcast_to(np.asarray(colour, float), radiance.shape)
    radiance[where] = colours[where]
    return radiance


def srgb_to_linear(encoded: ArrayLike) -> Array:
    """IEC 61966-2-1, of values from 0 to 1."""
    c = np.asarray(encoded, float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
