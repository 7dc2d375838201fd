"""How light is measured: energy, flux, irradiance, intensity, radiance.

Arguments are SI units and arrays that broadcast, results float64. The chain
of definitions (Pharr, Jakob and Humphreys, Physically Based Rendering,
section 4.1) goes from energy down to radiance, and its integrals back::

    energy Q [J]                     photons: h c / wavelength each
    flux P = dQ / dt [W]             energy over time
    irradiance E = dP / dA [W/m^2]   flux over area; exitance if it leaves
    intensity I = dP / dw [W/sr]     flux over solid angle
    radiance L = dP / (dw dA cos t)  flux over both [W/(m^2 sr)]

Photometric quantities (lumen, lux, candela, nit) are the same chain, each
weighted by the sensitivity of the eye.
"""

import numpy as np
from numpy.typing import ArrayLike

from moka.core.maths import Array
from moka.core.solid_angle import SPHERE

__all__ = [
    "LUMINOUS_EFFICACY",
    "NARROWEST_CONE_EDGE",
    "PLANCK_CONSTANT",
    "SPEED_OF_LIGHT",
    "energy_from_flux",
    "flux_from_energy",
    "flux_from_irradiance",
    "intensity_from_flux",
    "irradiance_at_distance",
    "irradiance_from_cone",
    "irradiance_from_flux",
    "irradiance_from_radiance",
    "luminous_from_radiant",
    "photon_energy",
    "point_flux",
    "radiance_from_flux",
    "radiant_from_luminous",
    "sphere_flux",
    "sphere_intensity",
    "spot_flux",
]

# Defining constants of the SI (BIPM, The International System of Units, 9th
# edition, 2019, table 1): exact, by definition.

#: Joule seconds.
PLANCK_CONSTANT = 6.62607015e-34
#: Metres per second, in a vacuum.
SPEED_OF_LIGHT = 299_792_458.0
#: Lumens per watt of light of 540 THz, a green of 555 nm.
LUMINOUS_EFFICACY = 683.0

#: The least difference of cosines between the cones of a spot light: the
#: limit that KHR_lights_punctual sets.
NARROWEST_CONE_EDGE = 0.001


def photon_energy(wavelength: ArrayLike) -> Array:
    """Joules that a photon of ``wavelength`` metres carries: h c / lambda.

    The wavelength is that in a vacuum; 400 to 700 nm are visible.
    """
    quantum = PLANCK_CONSTANT * SPEED_OF_LIGHT
    return quantum / _array(wavelength)


def energy_from_flux(flux: ArrayLike, time: ArrayLike) -> Array:
    """Joules (...) that a flux (..., N) in watts carries over ``time``.

    The flux is given at N increasing times (N,) in seconds and taken as
    linear in between, which makes its integral a sum of trapezia.
    """
    flux = _array(flux)
    mean = 0.5 * (flux[..., 1:] + flux[..., :-1])
    return _array(mean @ np.diff(_array(time)))


def flux_from_energy(energy: ArrayLike, time: ArrayLike) -> Array:
    """Mean watts (..., N - 1) between N times (N,) in seconds.

    ``energy`` (..., N) is what has passed by then, in joules.
    """
    return _array(np.diff(_array(energy)) / np.diff(_array(time)))


def irradiance_from_flux(flux: ArrayLike, area: ArrayLike) -> Array:
    """Watts per square metre of a flux that is even over an area.

    Irradiance if the light arrives there, radiant exitance if it leaves.
    """
    return _array(flux) / _array(area)


def flux_from_irradiance(irradiance: ArrayLike, area: ArrayLike) -> Array:
    """Watts through a surface in parts: the sum of E dA.

    ``irradiance`` is (*parts, ...) in W/m^2 and ``area`` (*parts) in m^2;
    what follows the parts, a colour for example, is the result's shape.
    """
    return _weighted_sum(irradiance, area)


def intensity_from_flux(
    flux: ArrayLike, solid_angle: ArrayLike = SPHERE
) -> Array:
    """Watts per steradian of a flux that is even over a solid angle.

    By default over all directions: I = P / (4 pi), at any distance.
    """
    return _array(flux) / _array(solid_angle)


def irradiance_at_distance(
    intensity: ArrayLike, distance: ArrayLike, cosine: ArrayLike = 1.0
) -> Array:
    """The inverse square law: I cos t / d^2, in W/m^2.

    ``intensity`` is that of a point, in W/sr, ``distance`` in metres, and
    ``cosine`` between the surface's normal and the light; a surface that
    faces away receives nothing. Candela become lux in the same way.
    """
    facing = np.maximum(_array(cosine), 0.0)
    return _array(intensity) * facing / _array(distance) ** 2


def radiance_from_flux(
    flux: ArrayLike,
    area: ArrayLike,
    solid_angle: ArrayLike,
    cosine: ArrayLike = 1.0,
) -> Array:
    """Radiance, in W/(m^2 sr), of a flux even over area and solid angle.

    ``cosine`` between the surface's normal and the light gives the projected
    area: P / (A cos t w).
    """
    projected = _array(area) * _array(cosine)
    return _array(flux) / (projected * _array(solid_angle))


def irradiance_from_radiance(
    radiance: ArrayLike, cosine: ArrayLike, solid_angle: ArrayLike
) -> Array:
    """Irradiance from a map of radiance: the sum of L cos t dw, in W/m^2.

    ``radiance`` is (*texels, ...) in W/(m^2 sr), ``cosine`` and
    ``solid_angle`` (*texels); what follows the texels, a colour for example,
    is the result's shape. Light from below the horizon does not count.
    """
    facing = np.maximum(_array(cosine), 0.0)
    return _weighted_sum(radiance, facing * _array(solid_angle))


def irradiance_from_cone(
    radiance: ArrayLike, half_angle: ArrayLike = 0.5 * np.pi
) -> Array:
    """Irradiance from the same radiance in a cone around the normal.

    The integral of L cos t dw: pi L sin^2 t for a cone of ``half_angle`` t
    radians, up to pi / 2. By default it is the whole hemisphere, and E is
    pi L. That is also the exitance of a surface of radiance L everywhere.
    """
    projected = np.pi * _array(np.sin(_array(half_angle))) ** 2
    return _array(radiance) * projected


def point_flux(intensity: ArrayLike) -> Array:
    """Watts of a point light of ``intensity`` W/sr in all directions.

    Lumens of candela, for the lights of KHR_lights_punctual.
    """
    return SPHERE * _array(intensity)


def spot_flux(
    intensity: ArrayLike, inner_angle: ArrayLike, outer_angle: ArrayLike
) -> Array:
    """Watts of a spot light of KHR_lights_punctual; lumens of candela.

    ``intensity`` is that inside the inner cone, in W/sr; the angles are half
    angles in radians, 0 <= inner <= outer <= pi / 2. Between the cones
    intensity falls as the square of (cos t - cos outer) / (cos inner - cos
    outer), whose integral over the sphere this is.
    """
    inner, outer = np.cos(_array(inner_angle)), np.cos(_array(outer_angle))
    edge = np.maximum(inner - outer, NARROWEST_CONE_EDGE)
    # Differences of cosines: of the whole cone and of its dimmed part.
    cone = 1.0 - outer
    dimmed = np.minimum(edge, cone)
    share = cone - dimmed + dimmed**3 / (3.0 * edge**2)
    return 2.0 * np.pi * _array(intensity) * _array(share)


def sphere_intensity(radiance: ArrayLike, radius: ArrayLike) -> Array:
    """W/sr of a sphere of ``radius`` metres and the same radiance all over.

    Radiance times the area that it shows: pi r^2 L. With the inverse square
    law it gives the irradiance on a surface that sees the whole sphere
    exactly, at any distance from its centre.
    """
    return np.pi * _array(radius) ** 2 * _array(radiance)


def sphere_flux(radiance: ArrayLike, radius: ArrayLike) -> Array:
    """Watts of a sphere of ``radius`` metres and the same radiance all over.

    The exitance pi L times the area 4 pi r^2.
    """
    return point_flux(sphere_intensity(radiance, radius))


def luminous_from_radiant(
    radiant: ArrayLike, efficiency: ArrayLike = 1.0
) -> Array:
    """Lumens of watts, and so lux of W/m^2 and candela of W/sr.

    683 lm/W times the luminous ``efficiency`` V, 0 to 1: what the eye makes
    of that light, 1 at its best, at 555 nm (CIE S 010:2004).
    """
    return LUMINOUS_EFFICACY * _array(efficiency) * _array(radiant)


def radiant_from_luminous(
    luminous: ArrayLike, efficiency: ArrayLike = 1.0
) -> Array:
    """Watts of lumens: the inverse of :func:`luminous_from_radiant`."""
    return _array(luminous) / (LUMINOUS_EFFICACY * _array(efficiency))


def _weighted_sum(values: ArrayLike, weights: ArrayLike) -> Array:
    values, weights = _array(values), _array(weights)
    return _array(np.tensordot(weights, values, axes=weights.ndim))


def _array(values: ArrayLike) -> Array:
    return np.asarray(values, np.float64)
