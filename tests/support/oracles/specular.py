"""Specular terms and their directional albedo, in float64.

D, V and F are written as in their papers, which is not how the shaders
write them.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.support.oracles.directions import gauss_legendre

Array = NDArray[np.float64]

#: (n.l, n.v, alpha) to G / (4 n.l n.v)
Visibility = Callable[[Array, Array, Array], Array]


def ggx(n_dot_h: ArrayLike, alpha: ArrayLike) -> Array:
    """D of Walter et al. 2007, equation 33, with the tangent of theta_h."""
    cosine, alpha = np.asarray(n_dot_h), np.asarray(alpha)
    tangent_squared = (1.0 - cosine**2) / cosine**2
    return alpha**2 / (np.pi * cosine**4 * (alpha**2 + tangent_squared) ** 2)


def smith_lambda(cosine: ArrayLike, alpha: ArrayLike) -> Array:
    """Heitz 2014, equations 72 and 73: (sqrt(1 + alpha^2 tan^2) - 1) / 2."""
    cosine, alpha = np.asarray(cosine), np.asarray(alpha)
    tangent_squared = (1.0 - cosine**2) / cosine**2
    return (np.sqrt(1.0 + alpha**2 * tangent_squared) - 1.0) / 2.0


def smith_correlated(n_dot_l: Array, n_dot_v: Array, alpha: Array) -> Array:
    """G2 / (4 n.l n.v) with Heitz 2014, equation 99."""
    g = 1.0 / (
        1.0 + smith_lambda(n_dot_l, alpha) + smith_lambda(n_dot_v, alpha)
    )
    return g / (4.0 * n_dot_l * n_dot_v)


def smith_separable(n_dot_l: Array, n_dot_v: Array, alpha: Array) -> Array:
    """G1 G1 / (4 n.l n.v): Walter et al. 2007, equation 23."""
    g = 1.0 / (1.0 + smith_lambda(n_dot_l, alpha))
    g = g / (1.0 + smith_lambda(n_dot_v, alpha))
    return g / (4.0 * n_dot_l * n_dot_v)


def schlick_ggx(n_dot_l: Array, n_dot_v: Array, k: ArrayLike) -> Array:
    """G1 G1 / (4 n.l n.v) with Karis 2013, equation 4."""
    k = np.asarray(k)
    g_light = n_dot_l / (n_dot_l * (1.0 - k) + k)
    g_view = n_dot_v / (n_dot_v * (1.0 - k) + k)
    return g_light * g_view / (4.0 * n_dot_l * n_dot_v)


def schlick_ggx_environment(
    n_dot_l: Array, n_dot_v: Array, alpha: Array
) -> Array:
    """The same with Karis' k = alpha / 2 for environments."""
    return schlick_ggx(n_dot_l, n_dot_v, alpha / 2.0)


def blinn_phong(n_dot_h: ArrayLike, alpha: ArrayLike) -> Array:
    """The normalised lobe; exponent 2 / alpha^2 - 2.

    The scale makes it reflect exactly 1 at normal incidence, where it is
    the integral of cos^n(theta / 2) cos(theta) over the hemisphere.
    """
    n = 2.0 / np.asarray(alpha) ** 2 - 2.0
    scale = (n + 2.0) * (n + 4.0) / (8.0 * np.pi * (2.0 ** (-n / 2.0) + n))
    return scale * np.asarray(n_dot_h) ** n


def schlick(cosine: ArrayLike, f0: ArrayLike, f90: ArrayLike = 1.0) -> Array:
    """Schlick 1994, equation 15."""
    f0 = np.asarray(f0)
    return f0 + (f90 - f0) * (1.0 - np.asarray(cosine)) ** 5


def dielectric(
    ior: float = 1.5,
    factor: float = 1.0,
    colour: ArrayLike = (1.0, 1.0, 1.0),
) -> tuple[Array, float]:
    """F0 (3,) and F90 of a dielectric by its extensions' texts.

    KHR_materials_ior: ((ior - 1) / (ior + 1))^2. KHR_materials_specular:
    times the colour, at most 1, and both times the factor.
    """
    f0 = np.array([((ior - 1.0) / (ior + 1.0)) ** 2] * 3)
    return np.minimum(f0 * np.asarray(colour), 1.0) * factor, factor


def table_of_microfacets(
    n_dot_v: ArrayLike,
    roughness: ArrayLike,
    visibility: Visibility,
    nodes: int = 48,
) -> Array:
    """Scale and bias of f0 and f90, shape (..., 2), for D of GGX."""
    return _table(
        n_dot_v,
        roughness,
        lambda n_dot_l, n_dot_v, _n_dot_h, alpha: visibility(
            n_dot_l, n_dot_v, alpha
        ),
        nodes,
    )


def table_of_blinn_phong(
    n_dot_v: ArrayLike, roughness: ArrayLike, nodes: int = 48
) -> Array:
    """The same for the normalised Blinn-Phong lobe."""
    return _table(
        n_dot_v,
        roughness,
        lambda _n_dot_l, _n_dot_v, n_dot_h, alpha: (
            blinn_phong(n_dot_h, alpha) / ggx(n_dot_h, alpha)
        ),
        nodes,
    )


def _table(
    n_dot_v: ArrayLike,
    roughness: ArrayLike,
    lobe_over_d: Callable[[Array, Array, Array, Array], Array],
    nodes: int,
) -> Array:
    """Integrate the lobe n.l over the hemisphere, over half vectors.

    For v in the x-z plane, n.l is R cos(2 theta - delta) with delta =
    atan2(v.x cos(phi), v.z), so the horizon is a limit of theta and the
    integrand smooth inside. theta is stretched as tan(theta) = alpha
    tan(psi), which flattens D; phi is clustered where the horizon jumps
    for grazing v. Gauss-Legendre in both; 48 nodes are good to 2e-4.
    """
    n_dot_v, roughness = np.broadcast_arrays(
        np.asarray(n_dot_v, float), np.asarray(roughness, float)
    )
    cosine_v = n_dot_v[..., None, None]
    alpha = roughness[..., None, None] ** 2
    sine_v = np.sqrt(1.0 - cosine_v**2)

    unit, weight = gauss_legendre(nodes)
    clustered, density = unit**4, 4.0 * unit**3 * weight
    phi = np.concatenate((1.0 - clustered, 1.0 + clustered)) * np.pi / 2.0
    phi_weight = np.concatenate((density, density)) * np.pi / 2.0
    phi, phi_weight = phi[:, None], phi_weight[:, None]

    delta = np.arctan2(sine_v * np.cos(phi), cosine_v)
    horizon = (delta + np.pi / 2.0) / 2.0
    limit = np.arctan(np.tan(horizon) / alpha)
    psi = limit * unit
    theta = np.arctan(alpha * np.tan(psi))
    n_dot_h = np.cos(theta)
    v_dot_h = sine_v * np.sin(theta) * np.cos(phi) + cosine_v * n_dot_h
    n_dot_l = np.maximum(2.0 * v_dot_h * n_dot_h - cosine_v, 1e-300)

    # D n.h dh = sin(2 psi) dpsi dphi / 2 pi; dl = 4 v.h dh; phi is half.
    measure = np.sin(2.0 * psi) * limit * weight * phi_weight / np.pi
    lobe = lobe_over_d(n_dot_l, cosine_v, n_dot_h, alpha)
    integrand = lobe * n_dot_l * 4.0 * v_dot_h / n_dot_h * measure
    fresnel = (1.0 - v_dot_h) ** 5
    scale = np.sum((1.0 - fresnel) * integrand, axis=(-2, -1))
    bias = np.sum(fresnel * integrand, axis=(-2, -1))
    return np.stack((scale, bias), axis=-1)
