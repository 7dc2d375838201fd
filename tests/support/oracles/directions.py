"""Directions and quadrature over the hemisphere around +Z, in float64."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def gauss_legendre(count: int) -> tuple[Array, Array]:
    """Nodes and weights on 0..1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (nodes + 1.0) / 2.0, weights / 2.0


def spherical(cosine: ArrayLike, azimuth: ArrayLike) -> Array:
    """Unit vectors (..., 3) at a cosine from +Z and an azimuth from +X."""
    cosine, azimuth = np.broadcast_arrays(
        np.asarray(cosine, float), np.asarray(azimuth, float)
    )
    sine = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
    return np.stack(
        (sine * np.cos(azimuth), sine * np.sin(azimuth), cosine), axis=-1
    )


def hemisphere(cosines: int, azimuths: int) -> tuple[Array, Array]:
    """Directions (N, 3) and weights (N,): sum(w f) is the integral of f n.l.

    Gauss-Legendre in n.l and equal steps in azimuth, which is accurate for
    smooth functions.
    """
    nodes, weights = gauss_legendre(cosines)
    step = 2.0 * np.pi / azimuths
    azimuth = (np.arange(azimuths) + 0.5) * step
    directions = spherical(nodes[:, None], azimuth[None, :])
    weight = (nodes * weights)[:, None] * np.full(azimuths, step)
    return directions.reshape(-1, 3), weight.reshape(-1)


def random_directions(
    count: int, seed: int, lowest_cosine: float = 0.0
) -> Array:
    """Uniform unit vectors (count, 3) with z from ``lowest_cosine`` to 1."""
    generator = np.random.default_rng(seed)
    cosine = generator.uniform(lowest_cosine, 1.0, count)
    return spherical(cosine, generator.uniform(0.0, 2.0 * np.pi, count))


def dot(a: Array, b: Array) -> Array:
    """Row by row."""
    return np.sum(a * b, axis=-1)


def half_vectors(v: Array, l: Array) -> Array:  # noqa: E741
    """The unit vectors halfway between ``v`` and ``l``."""
    total = v + l
    return total / np.linalg.norm(total, axis=-1, keepdims=True)
