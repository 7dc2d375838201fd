"""Fresnel's equations: what a smooth surface reflects, exactly.

Shaders use Schlick's approximation; this is what it approximates. Cosines
are those between the light and the surface normal, 0 to 1. A material is
described by its index of refraction relative to the medium in front of it:
n for a dielectric, n + i k for a conductor, which absorbs. Indices depend on
the wavelength; a colour has one for each channel.

Source: Born and Wolf, Principles of Optics, 7th edition: sections 1.5.2
(dielectrics), 1.5.4 (total reflection) and 14.2 (conductors).
"""

import numpy as np
from numpy.typing import ArrayLike

from moka.core.maths import Array

__all__ = [
    "fresnel_conductor",
    "fresnel_dielectric",
    "fresnel_polarised",
    "index_from_reflectance",
    "reflectance_from_index",
]


def fresnel_polarised(
    cosine: ArrayLike, index: ArrayLike
) -> tuple[Array, Array]:
    """Reflectances of light polarised across (s) and in (p) the plane.

    The plane is that of light and normal; ``index`` is real or complex. With
    q = sqrt(n^2 - sin^2 t), which is n times the cosine inside::

        R_s = |(cos t - q) / (cos t + q)|^2
        R_p = |(n^2 cos t - q) / (n^2 cos t + q)|^2

    q is imaginary where light cannot leave a denser medium, and both are 1.
    """
    cosine = np.asarray(cosine, np.float64)
    squared = np.asarray(index, np.complex128) ** 2
    # n^2 - sin^2 t without a difference of numbers near 1.
    inside = np.sqrt((squared - 1.0) + cosine**2)
    return (
        _squared_ratio(cosine - inside, cosine + inside),
        _squared_ratio(squared * cosine - inside, squared * cosine + inside),
    )


def fresnel_dielectric(cosine: ArrayLike, index: ArrayLike) -> Array:
    """Reflectance of unpolarised light at a dielectric, 0 to 1.

    ``index`` is n behind the surface over n before it: 1.5 for glass seen
    from the air, 1 / 1.5 for air seen from the glass, which reflects all
    light beyond its critical angle.
    """
    across, along = fresnel_polarised(cosine, np.asarray(index, np.float64))
    return 0.5 * (across + along)


def fresnel_conductor(
    cosine: ArrayLike, index: ArrayLike, extinction: ArrayLike
) -> Array:
    """Reflectance of unpolarised light at a metal, 0 to 1.

    The complex index is ``index`` + i ``extinction``.
    """
    complex_index = np.asarray(index) + 1j * np.asarray(extinction)
    across, along = fresnel_polarised(cosine, complex_index)
    return 0.5 * (across + along)


def reflectance_from_index(
    index: ArrayLike, extinction: ArrayLike = 0.0
) -> Array:
    """F0: the reflectance at normal incidence; 0.04 for an index of 1.5.

    ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
    """
    index = np.asarray(index, np.float64)
    absorbed = np.asarray(extinction, np.float64) ** 2
    return ((index - 1.0) ** 2 + absorbed) / ((index + 1.0) ** 2 + absorbed)


def index_from_reflectance(reflectance: ArrayLike) -> Array:
    """The index of a dielectric, at least 1, of F0 from 0 to below 1."""
    root = np.sqrt(np.asarray(reflectance, np.float64))
    return (1.0 + root) / (1.0 - root)


def _squared_ratio(numerator: ArrayLike, denominator: ArrayLike) -> Array:
    """|a / b|^2; 0 for 0 / 0, which is grazing light and an index of 1."""
    below = np.abs(denominator)
    ratio = np.abs(numerator) / np.where(below > 0.0, below, 1.0)
    return np.asarray(ratio * ratio)
