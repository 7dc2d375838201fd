"""Fresnel's equations against the fields that they come from."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.fresnel import (
    fresnel_conductor,
    fresnel_dielectric,
    fresnel_polarised,
    index_from_reflectance,
    reflectance_from_index,
)

GLASS = 1.5
GOLD = 0.143 + 3.983j  # of red light
COSINES = np.linspace(0.01, 1.0, 100)


def boundary_reflectances(cosine: float, index: complex) -> tuple[float, float]:
    """R of both polarisations from Maxwell's boundary conditions.

    Along the surface the fields E and H are continuous, which is two linear
    equations for the amplitudes of the reflected and the refracted wave.
    """
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2 + 0j)
    if (index * inside).imag < 0.0:  # it must decay, not grow
        inside = -inside
    # E across the plane: 1 + r = t, (1 - r) cos = n cos' t.
    across = [[-1.0, 1.0], [cosine, index * inside]]
    # H across it: 1 + r = n t, (1 - r) cos = cos' t.
    along = [[-1.0, index], [cosine, inside]]
    s, p = (
        abs(np.linalg.solve(np.array(matrix), [1.0, cosine])[0]) ** 2
        for matrix in (across, along)
    )
    return s, p


@pytest.mark.parametrize("index", [GLASS, 1.0 / GLASS, 2.4, GOLD, 1.4 + 7.6j])
def test_reflectances_solve_the_boundary_conditions(index: complex) -> None:
    expected = np.array([boundary_reflectances(c, index) for c in COSINES])
    s, p = fresnel_polarised(COSINES, index)
    assert_allclose(s, expected[:, 0], atol=1e-12)
    assert_allclose(p, expected[:, 1], atol=1e-12)


def test_unpolarised_light_is_half_of_each() -> None:
    s, p = fresnel_polarised(COSINES, GOLD)
    value = fresnel_conductor(COSINES, GOLD.real, GOLD.imag)
    assert_allclose(value, 0.5 * (s + p))
    assert_allclose(
        fresnel_conductor(COSINES, GLASS, 0.0),
        fresnel_dielectric(COSINES, GLASS),
        atol=1e-15,
    )


@pytest.mark.parametrize("index", [1.1, GLASS, 2.4])
def test_at_brewsters_angle_one_polarisation_is_not_reflected(
    index: float,
) -> None:
    s, p = fresnel_polarised(np.cos(np.arctan(index)), index)
    assert p == pytest.approx(0.0, abs=1e-28)
    assert s > 0.0


def test_light_is_reflected_in_full_beyond_the_critical_angle() -> None:
    critical = np.sqrt(1.0 - 1.0 / GLASS**2)
    beyond = np.linspace(0.0, critical - 1e-9, 50)
    assert_allclose(fresnel_dielectric(beyond, 1.0 / GLASS), 1.0, rtol=1e-12)
    assert fresnel_dielectric(critical + 1e-2, 1.0 / GLASS) < 0.7


@given(st.floats(0.0, 1.0), st.floats(1.01, 4.0))
def test_a_surface_reflects_the_same_from_both_sides(
    cosine: float, index: float
) -> None:
    """Stokes: along the same ray, there and back."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / index**2)
    forth = fresnel_dielectric(cosine, index)
    assert fresnel_dielectric(inside, 1.0 / index) == pytest.approx(
        forth, abs=1e-6
    )


@given(st.floats(0.0, 1.0), st.floats(0.05, 5.0), st.floats(0.0, 10.0))
def test_no_more_is_reflected_than_arrives(
    cosine: float, index: float, extinction: float
) -> None:
    for value in fresnel_polarised(cosine, complex(index, extinction)):
        assert 0.0 <= value <= 1.0 + 1e-12


def test_normal_and_grazing_incidence() -> None:
    assert fresnel_dielectric(1.0, GLASS) == pytest.approx(0.04)
    assert reflectance_from_index(GLASS) == pytest.approx(0.04)
    assert reflectance_from_index(1.333) == pytest.approx(0.0204, abs=1e-4)
    gold = reflectance_from_index(GOLD.real, GOLD.imag)
    assert gold == pytest.approx(0.967, abs=5e-4)
    assert fresnel_conductor(1.0, GOLD.real, GOLD.imag) == pytest.approx(gold)
    assert fresnel_dielectric(0.0, GLASS) == 1.0
    assert fresnel_conductor(0.0, GOLD.real, GOLD.imag) == 1.0


def test_where_nothing_changes_nothing_is_reflected() -> None:
    assert not fresnel_dielectric([0.0, 1e-9, 0.5, 1.0], 1.0).any()


@given(st.floats(0.0, 0.99))
def test_the_index_of_a_reflectance(reflectance: float) -> None:
    index = index_from_reflectance(reflectance)
    assert index >= 1.0
    assert reflectance_from_index(index) == pytest.approx(
        reflectance, abs=1e-12
    )


def test_a_colour_has_an_index_for_each_channel() -> None:
    indices = np.array([0.143, 0.375, 1.442])
    extinctions = np.array([3.983, 2.386, 1.603])
    gold = fresnel_conductor(COSINES[:, None], indices, extinctions)
    assert gold.shape == (100, 3)
    # Yellow: red and green come back, blue less.
    assert gold[-1, 0] > gold[-1, 1] > gold[-1, 2]
