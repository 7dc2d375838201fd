"""The disc of a sun: directions in it, and what a surface reflects of it."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.support.oracles.directions import gauss_legendre, half_vectors
from tests.support.oracles.environment import around
from tests.support.oracles.specular import ggx, schlick, smith_correlated

Array = NDArray[np.float64]

# Rings and steps around; the edges of lobes a tenth of the disc are resolved.
RINGS, STEPS = 64, 128


def directions(centre: Array, radius: float) -> tuple[Array, Array]:
    """Unit vectors (N, 3) over a disc, and weights whose sum is 1."""
    nodes, weights = gauss_legendre(RINGS)
    # By solid angle: 1 - cos(angle) is even. Its sine does not cancel.
    versine = nodes * 2.0 * np.sin(radius / 2.0) ** 2
    sine = np.sqrt(versine * (2.0 - versine))
    azimuth = (np.arange(STEPS) + 0.5) / STEPS * 2.0 * np.pi
    plane = np.stack(
        (
            sine[:, None] * np.cos(azimuth),
            sine[:, None] * np.sin(azimuth),
            np.broadcast_to(1.0 - versine[:, None], (RINGS, STEPS)),
        ),
        axis=-1,
    )
    return plane.reshape(-1, 3) @ around(centre), np.repeat(
        weights / STEPS, STEPS
    )


def mean_distribution(
    view: Array, centre: Array, alpha: float, radius: float
) -> float:
    """D of GGX around +Z, averaged over the half vectors that see a disc."""
    towards, weights = directions(centre, radius)
    h = half_vectors(np.broadcast_to(view, towards.shape), towards)
    # Of sines, where a cosine near 1 would lose digits.
    sine = h[:, 0] ** 2 + h[:, 1] ** 2
    k = alpha / (sine + (h[:, 2] * alpha) ** 2)
    return float(weights @ (k * k / np.pi))


def reflected(
    normal: Array,
    view: Array,
    centre: Array,
    radius: float,
    roughness: float,
    f0: ArrayLike,
) -> Array:
    """The lobe's radiance (3,) towards ``view`` for an irradiance of 1."""
    f0 = np.asarray(f0, float)
    alpha = roughness**2
    n_dot_v = float(normal @ view)
    if alpha == 0.0:
        mirrored = 2.0 * n_dot_v * normal - view
        inside = np.linalg.norm(mirrored - centre) < 2.0 * np.sin(radius / 2.0)
        disc = float(inside) / (np.pi * np.sin(radius) ** 2)
        return schlick(n_dot_v, f0) * disc
    towards, weights = directions(centre, radius)
    h = half_vectors(np.broadcast_to(view, towards.shape), towards)
    n_dot_l = np.maximum(towards @ normal, 1e-12)
    lobe = ggx(h @ normal, alpha) * smith_correlated(n_dot_l, n_dot_v, alpha)
    fresnel = schlick((h @ view)[:, None], f0)
    return (weights * lobe * n_dot_l) @ fresnel
