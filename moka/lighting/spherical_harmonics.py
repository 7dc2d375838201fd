"""Irradiance as nine coefficients of spherical harmonics.

Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance
Environment Maps": the cosine lobe passes hardly more than the bands 0 to 2,
so that nine colours say what a convolved cube map would, without one. What
the missing bands leave is small unless the map has a sun, and it is measured
for every map (:func:`irradiance_error`).
"""

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.lighting.equirectangular import solid_angles, uv_to_direction
from moka.lighting.samples import hammersley

__all__ = ["evaluate", "irradiance_error", "irradiance_harmonics"]

Array = NDArray[np.float64]

# Rows of blocks a map is reduced to first. Within a block of 2.8 degrees
# harmonics up to band 2 vary by less than a thousandth; to judge them, and
# 64 normals, a quarter of the blocks will do.
_ROWS = 64
_ROWS_TO_JUDGE = 32
# Of the mean of the light, over bands 0 to 2: pi, 2 pi / 3 and pi / 4
# (equation 8), divided by pi for a surface that reflects everything.
_COSINE_LOBE = np.array([1, 2 / 3, 2 / 3, 2 / 3, *[1 / 4] * 5])
# The squares of the normalisations of real harmonics (equation 3).
_NORMALISATION = np.array([1, 3, 3, 3, 15, 15, 5 / 4, 15, 15 / 4]) / (4 * np.pi)


def irradiance_harmonics(pixels: NDArray[np.float32]) -> Array:
    """Coefficients (9, 3) of E / pi of an equirectangular map (H, W, 3).

    For :func:`evaluate`, which leaves all constants to them.
    """
    directions, flux = _blocks(pixels, _ROWS)
    scale = _COSINE_LOBE * _NORMALISATION
    coefficients: Array = scale[:, np.newaxis] * (_basis(directions).T @ flux)
    return coefficients


def evaluate(coefficients: Array, normals: NDArray[Any]) -> Array:
    """E / pi (N, 3) for unit ``normals`` (N, 3), as the shader has it."""
    values: Array = np.maximum(_basis(normals) @ coefficients, 0.0)
    return values


def irradiance_error(pixels: NDArray[np.float32], coefficients: Array) -> float:
    """The largest error of E / pi over 64 normals and all channels.

    It is relative to the channel's mean over these normals. The truth is
    the sum over the blocks of the map.
    """
    directions, flux = _blocks(pixels, _ROWS_TO_JUDGE)
    normals = _normals()
    exact = np.maximum(normals @ directions.T, 0.0) @ flux / np.pi
    error = np.abs(evaluate(coefficients, normals) - exact).max(axis=0)
    mean = exact.mean(axis=0)
    return float(np.max(error / np.where(mean > 0.0, mean, 1.0)))


def _basis(directions: NDArray[Any]) -> Array:
    """The polynomials (N, 9) of bands 0, 1, 1, 1, 2, 2, 2, 2, 2."""
    x, y, z = np.asarray(directions, np.float64).T
    one = np.ones_like(x)
    bands = (one, x, y, z, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y)
    return np.stack(bands, axis=-1)


def _blocks(pixels: NDArray[np.float32], most: int) -> tuple[Array, Array]:
    """Directions (N, 3) and flux (N, 3) of blocks in up to ``most`` rows."""
    height, width, _ = pixels.shape
    if height < most:
        # Texels of a small map are blocks already, and too large.
        pixels = pixels.repeat(-(-most // height), axis=0)
        pixels = pixels.repeat(-(-2 * most // width), axis=1)
        height, width, _ = pixels.shape
    areas = solid_angles(height, width)[:, 0].astype(np.float32)
    rows = np.linspace(0, height, most + 1).astype(np.intp)
    columns = np.linspace(0, width, 2 * most + 1).astype(np.intp)
    flat = pixels.reshape(height, width * 3)
    # As products of matrices, which are several times as fast as sums.
    bands = np.stack(
        [
            areas[start:stop] @ flat[start:stop]
            for start, stop in pairwise(rows.tolist())
        ]
    ).reshape(-1, width, 3)
    flux = np.add.reduceat(bands, columns[:-1], axis=1, dtype=np.float64)
    u = (columns[:-1] + columns[1:]) / (2 * width)
    v = (rows[:-1] + rows[1:]) / (2 * height)
    directions = uv_to_direction(np.stack(np.meshgrid(u, v), axis=-1))
    return directions.reshape(-1, 3), flux.reshape(-1, 3)


@cache
def _normals() -> Array:
    """64 directions, evenly over the sphere."""
    azimuth, height = hammersley(64).T
    z = 1.0 - 2.0 * height
    radius = np.sqrt(1.0 - z * z)
    angle = 2.0 * np.pi * azimuth
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], -1)
