"""The equirectangular map: directions, texture coordinates, solid angles.

u = 0.5 + atan2(z, x) / 2 pi and v = acos(y) / pi from the top, so that the
middle of the map is +X, its right quarter +Z and its top +Y. The shaders'
``include/environment.glsl`` is the same mapping.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.solid_angle import (
    equirectangular_texel_solid_angles as solid_angles,
)

__all__ = [
    "direction_to_uv",
    "mean_radiance",
    "solid_angles",
    "texel_directions",
    "uv_to_direction",
]


def direction_to_uv(direction: ArrayLike) -> NDArray[np.float64]:
    """Texture coordinates (..., 2) of directions (..., 3) of any length.

    u is 0 to 1, v is 0 at +Y and 1 at -Y; u is arbitrary at the poles.
    """
    x, y, z = np.moveaxis(np.asarray(direction, np.float64), -1, 0)
    u = 0.5 + np.arctan2(z, x) / (2.0 * np.pi)
    # As acos(y) of a unit vector, but as exact at the poles as elsewhere.
    v = np.arctan2(np.hypot(x, z), y) / np.pi
    return np.stack([u, v], axis=-1)


def uv_to_direction(uv: ArrayLike) -> NDArray[np.float64]:
    """Unit directions (..., 3) of texture coordinates (..., 2)."""
    u, v = np.moveaxis(np.asarray(uv, np.float64), -1, 0)
    azimuth = (u - 0.5) * 2.0 * np.pi
    polar = v * np.pi
    radius = np.sin(polar)
    return np.stack(
        [radius * np.cos(azimuth), np.cos(polar), radius * np.sin(azimuth)],
        axis=-1,
    )


def texel_directions(height: int, width: int) -> NDArray[np.float64]:
    """Unit directions (H, W, 3) of the centres of a map's texels."""
    azimuth = (np.arange(width) + 0.5) / width * 2.0 * np.pi - np.pi
    polar = (np.arange(height) + 0.5)[:, np.newaxis] / height * np.pi
    directions = np.empty((height, width, 3))
    directions[:, :, 0] = np.sin(polar) * np.cos(azimuth)
    directions[:, :, 1] = np.cos(polar)
    directions[:, :, 2] = np.sin(polar) * np.sin(azimuth)
    return directions


def mean_radiance(pixels: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The mean (3,) over the sphere of a map (H, W, 3)."""
    height, width, _ = pixels.shape
    rows = pixels.mean(axis=1, dtype=np.float64)
    weights = solid_angles(height, width)[:, 0] * width / (4.0 * np.pi)
    mean: NDArray[np.float64] = weights @ rows
    return mean
