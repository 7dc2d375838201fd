"""Radiometry: how light is measured, and what surfaces do to it, exactly.

The public names of three modules: quantities of light (SI units), solid
angles, and Fresnel's equations. NumPy only, vectorised, float64. Lights, the
tests and the chapter of the documentation about theory use the same
functions::

    from moka import radiometry

    lux = radiometry.irradiance_at_distance(intensity=80.0, distance=2.0)
"""

from moka.core.fresnel import (
    fresnel_conductor,
    fresnel_dielectric,
    fresnel_polarised,
    index_from_reflectance,
    reflectance_from_index,
)
from moka.core.radiometry import (
    LUMINOUS_EFFICACY,
    NARROWEST_CONE_EDGE,
    PLANCK_CONSTANT,
    SPEED_OF_LIGHT,
    energy_from_flux,
    flux_from_energy,
    flux_from_irradiance,
    intensity_from_flux,
    irradiance_at_distance,
    irradiance_from_cone,
    irradiance_from_flux,
    irradiance_from_radiance,
    luminous_from_radiant,
    photon_energy,
    point_flux,
    radiance_from_flux,
    radiant_from_luminous,
    sphere_flux,
    sphere_intensity,
    spot_flux,
)
from moka.core.solid_angle import (
    SPHERE,
    cap_solid_angle,
    cone_half_angle,
    cone_solid_angle,
    cube_texel_solid_angles,
    equirectangular_texel_solid_angles,
    sphere_solid_angle,
)

__all__ = [
    "LUMINOUS_EFFICACY",
    "NARROWEST_CONE_EDGE",
    "PLANCK_CONSTANT",
    "SPEED_OF_LIGHT",
    "SPHERE",
    "cap_solid_angle",
    "cone_half_angle",
    "cone_solid_angle",
    "cube_texel_solid_angles",
    "energy_from_flux",
    "equirectangular_texel_solid_angles",
    "flux_from_energy",
    "flux_from_irradiance",
    "fresnel_conductor",
    "fresnel_dielectric",
    "fresnel_polarised",
    "index_from_reflectance",
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
    "reflectance_from_index",
    "sphere_flux",
    "sphere_intensity",
    "sphere_solid_angle",
    "spot_flux",
]
