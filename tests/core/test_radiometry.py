"""Radiometric relations against each other and against integrals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka import radiometry
from moka.core import fresnel, solid_angle
from moka.core import radiometry as core
from moka.model.lights import LightKind, PunctualLight
from moka.scene.lights import pack_lights

positive = st.floats(1e-3, 1e6)


def gauss_legendre(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(64)
    half = 0.5 * (high - low)
    return low + half * (nodes + 1.0), half * weights


def test_the_public_module_is_the_three_others() -> None:
    names = [*core.__all__, *fresnel.__all__, *solid_angle.__all__]
    assert sorted(radiometry.__all__) == sorted(names)
    for name in names:
        assert hasattr(radiometry, name)


def test_the_energy_of_photons() -> None:
    """Green light of 555 nm; in electronvolts, what tables of the visible
    spectrum have for violet and red."""
    assert core.photon_energy(555e-9) == pytest.approx(3.5792e-19, rel=1e-4)
    electronvolt = 1.602176634e-19
    energies = core.photon_energy([400e-9, 700e-9]) / electronvolt
    assert_allclose(energies, [3.0996, 1.7712], rtol=1e-4)


@given(positive, positive)
def test_a_constant_flux_over_time(flux: float, time: float) -> None:
    energy = core.energy_from_flux([flux, flux, flux], [0.0, 0.3 * time, time])
    assert energy == pytest.approx(flux * time)


def test_a_flux_that_swells_and_fades() -> None:
    time = np.linspace(0.0, 2.0, 2001)
    flux = np.sin(np.pi * time) ** 2 * np.array([[1.0], [3.0]])
    assert_allclose(core.energy_from_flux(flux, time), [1.0, 3.0], rtol=1e-9)


def test_energy_and_flux_there_and_back() -> None:
    generator = np.random.default_rng(1)
    time = np.cumsum(generator.uniform(0.1, 1.0, 50))
    energy = np.cumsum(generator.uniform(0.0, 1.0, (3, 50)), axis=1)
    flux = core.flux_from_energy(energy, time)
    assert flux.shape == (3, 49)
    total = (flux * np.diff(time)).sum(axis=1)
    assert_allclose(total, energy[:, -1] - energy[:, 0])


@given(positive, positive)
def test_spheres_around_a_point_all_take_its_flux(
    flux: float, radius: float
) -> None:
    intensity = core.intensity_from_flux(flux)
    irradiance = core.irradiance_at_distance(intensity, radius)
    area = 4.0 * np.pi * radius**2
    assert irradiance == pytest.approx(core.irradiance_from_flux(flux, area))
    assert core.flux_from_irradiance(irradiance, area) == pytest.approx(flux)
    assert core.point_flux(intensity) == pytest.approx(flux)


def test_twice_the_distance_is_a_quarter_of_the_light() -> None:
    near, far, tilted, behind = core.irradiance_at_distance(
        8.0, [1.0, 2.0, 2.0, 1.0], [1.0, 1.0, 0.5, -0.5]
    )
    assert (near, far, tilted, behind) == (8.0, 2.0, 1.0, 0.0)


def test_a_plane_takes_half_of_the_light_of_a_point_before_it() -> None:
    """The flux through rings of a plane at height 1, out to infinity."""
    cosine, weight = gauss_legendre(0.0, 1.0)
    # A ring's radius is tan t: its area is 2 pi tan t dt / cos^2 t.
    area = 2.0 * np.pi * weight / cosine**3
    irradiance = core.irradiance_at_distance(1.0, 1.0 / cosine, cosine)
    flux = core.flux_from_irradiance(irradiance, area)
    assert flux == pytest.approx(0.5 * core.point_flux(1.0))


@given(positive, positive, st.floats(0.01, 1.0))
def test_radiance_is_flux_over_projected_area_and_solid_angle(
    flux: float, area: float, cosine: float
) -> None:
    radiance = core.radiance_from_flux(flux, area, 0.01, cosine)
    assert radiance * area * cosine * 0.01 == pytest.approx(flux)


def test_the_irradiance_of_a_map() -> None:
    """L = (1, 1 + y, x^2) seen from below: E is known by hand."""
    height, width = 128, 256
    polar = (np.arange(height)[:, None] + 0.5) / height * np.pi
    azimuth = (np.arange(width) + 0.5) / width * 2.0 * np.pi
    y = np.broadcast_to(np.cos(polar), (height, width))
    x = np.sin(polar) * np.cos(azimuth)
    texels = solid_angle.equirectangular_texel_solid_angles(height, width)
    radiance = np.stack([np.ones_like(y), 1.0 + y, x * x], axis=-1)
    irradiance = core.irradiance_from_radiance(radiance, y, texels)
    expected = np.pi * np.array([1.0, 1.0 + 2.0 / 3.0, 0.25])
    assert_allclose(irradiance, expected, rtol=2e-4)


def test_the_irradiance_of_cones() -> None:
    assert core.irradiance_from_cone(3.0) == pytest.approx(3.0 * np.pi)
    for angle in (0.1, 0.8, 1.5):
        cosine, weight = gauss_legendre(np.cos(angle), 1.0)
        rings = 2.0 * np.pi * weight
        expected = core.irradiance_from_radiance(
            np.full(64, 2.0), cosine, rings
        )
        assert core.irradiance_from_cone(2.0, angle) == pytest.approx(expected)
    # A small light is as bright as its radiance times its solid angle.
    sun = core.irradiance_from_cone(1.0, 0.00465)
    cone = solid_angle.cone_solid_angle(0.00465)
    assert sun == pytest.approx(cone, rel=1e-5)


@given(st.floats(1.0, 1e4))
def test_a_sphere_obeys_the_inverse_square_law_exactly(distance: float) -> None:
    intensity = core.sphere_intensity(5.0, 1.0)
    seen = core.irradiance_from_cone(5.0, np.arcsin(1.0 / distance))
    assert core.irradiance_at_distance(intensity, distance) == pytest.approx(
        seen
    )


def test_a_sphere_emits_its_exitance_from_its_surface() -> None:
    exitance = core.irradiance_from_cone(5.0)
    area = 4.0 * np.pi * 0.3**2
    flux = core.sphere_flux(5.0, 0.3)
    assert flux == pytest.approx(exitance * area)
    assert core.intensity_from_flux(flux) == pytest.approx(
        core.sphere_intensity(5.0, 0.3)
    )


@pytest.mark.parametrize(
    ("inner", "outer"),
    [(0.0, 0.7), (0.3, 1.0), (0.5, 0.5), (0.0, 0.01), (0.0, 0.0), (1.0, 1.5)],
)
def test_a_spot_emits_what_shaders_compute_of_its_row(
    inner: float, outer: float
) -> None:
    light = PunctualLight(
        LightKind.SPOT,
        intensity=20.0,
        inner_cone_angle=inner,
        outer_cone_angle=outer,
    )
    (row,) = pack_lights([light], np.eye(4)[None])
    expected = 0.0
    bright = float(np.cos(outer)) + core.NARROWEST_CONE_EDGE
    bright = min(max(bright, float(np.cos(inner))), 1.0)
    # Where the clamp begins and ends the integrand has kinks.
    for low, high in ((np.cos(outer), bright), (bright, 1.0)):
        cosine, weight = gauss_legendre(low, high)
        cone = cosine * float(row["angle_scale"]) + float(row["angle_offset"])
        spot = np.clip(cone, 0.0, 1.0) ** 2
        expected += 2.0 * np.pi * float(row["intensity"][0]) * weight @ spot
    flux = core.spot_flux(20.0, inner, outer)
    # The row is float32, whose rounding counts in a cone of 0.01 radians.
    assert flux == pytest.approx(expected, rel=1e-2, abs=1e-4)
    assert flux <= 20.0 * solid_angle.cone_solid_angle(outer) + 1e-12


def test_a_spot_without_an_edge_is_a_cone() -> None:
    flux = core.spot_flux(1.0, [1.0, 0.5 * np.pi], [1.0, 0.5 * np.pi])
    cones = solid_angle.cone_solid_angle([1.0, 0.5 * np.pi])
    assert_allclose(flux, cones, rtol=2e-3)
    assert (flux < cones).all()


@given(positive, st.floats(1e-3, 1.0))
def test_lumens_of_watts_and_back(radiant: float, efficiency: float) -> None:
    luminous = core.luminous_from_radiant(radiant, efficiency)
    assert luminous == pytest.approx(683.0 * efficiency * radiant)
    assert core.radiant_from_luminous(luminous, efficiency) == pytest.approx(
        radiant
    )
