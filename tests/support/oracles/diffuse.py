"""Diffuse terms for a colour in 0..1, in float64."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def lambert(colour: ArrayLike) -> Array:
    """Lambert 1760."""
    return np.asarray(colour) / np.pi


def fujii_albedo(cosine: ArrayLike, roughness: ArrayLike) -> Array:
    """The exact albedo of Fujii's lobe: EON, Portsmouth et al. 2024, 13."""
    mu, r = np.asarray(cosine, float), np.asarray(roughness, float)
    a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * np.pi)) * r)
    sine = np.sqrt(1.0 - mu**2)
    g = sine * (np.arccos(mu) - sine * mu) + 2.0 / 3.0 * (
        sine / mu * (1.0 - sine**3) - sine
    )
    return a + r * a * g / np.pi


def oren_nayar(
    n_dot_l: Array,
    n_dot_v: Array,
    v_dot_l: Array,
    colour: ArrayLike,
    roughness: ArrayLike,
) -> Array:
    """EON, Portsmouth et al. 2024, equations 10 to 18, with exact albedos."""
    rho, r = np.asarray(colour, float), np.asarray(roughness, float)
    a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * np.pi)) * r)
    s = v_dot_l - n_dot_l * n_dot_v
    t = np.where(s > 0.0, np.maximum(n_dot_l, n_dot_v), 1.0)
    single = rho / np.pi * a * (1.0 + r * s / t)
    average = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * np.pi)) * r)
    multiple_colour = rho**2 * average / (1.0 - rho * (1.0 - average))
    lost_light = 1.0 - fujii_albedo(n_dot_l, r)
    lost_view = 1.0 - fujii_albedo(n_dot_v, r)
    multiple = multiple_colour / np.pi * lost_light * lost_view
    return single + multiple / np.maximum(1.0 - average, 1e-30)


def burley(
    n_dot_l: Array,
    n_dot_v: Array,
    v_dot_l: Array,
    colour: ArrayLike,
    roughness: ArrayLike,
    renormalised: bool,
) -> Array:
    """Burley 2012, section 5.3; or Lagarde and de Rousiers 2014, listing 2."""
    r = np.asarray(roughness, float)
    l_dot_h_squared = (1.0 + v_dot_l) / 2.0
    bias = 0.5 * r if renormalised else 0.5
    factor = (1.0 - r) + r / 1.51 if renormalised else 1.0
    f90 = bias + 2.0 * r * l_dot_h_squared
    light = 1.0 + (f90 - 1.0) * (1.0 - n_dot_l) ** 5
    view = 1.0 + (f90 - 1.0) * (1.0 - n_dot_v) ** 5
    return np.asarray(colour) / np.pi * light * view * factor
