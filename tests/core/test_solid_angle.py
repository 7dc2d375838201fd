"""Solid angles against integrals over the sphere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.solid_angle import (
    SPHERE,
    cap_solid_angle,
    cone_half_angle,
    cone_solid_angle,
    cube_texel_solid_angles,
    equirectangular_texel_solid_angles,
    sphere_solid_angle,
)


def integral(function, low: float, high: float) -> float:
    """Gauss-Legendre: 40 nodes are exact for what is integrated here."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    half = 0.5 * (high - low)
    return float(half * weights @ function(low + half * (nodes + 1.0)))


def test_cones_from_nothing_to_everything() -> None:
    angles = np.pi * np.array([0.0, 1.0 / 3.0, 0.5, 1.0])
    expected = np.pi * np.array([0.0, 1.0, 2.0, 4.0])
    assert_allclose(cone_solid_angle(angles), expected, atol=1e-15)
    assert cone_solid_angle(np.pi) == SPHERE


@pytest.mark.parametrize("angle", [0.01, 0.3, 1.2, 2.5])
def test_a_cone_is_the_integral_of_its_rings(angle: float) -> None:
    rings = integral(lambda t: 2.0 * np.pi * np.sin(t), 0.0, angle)
    assert cone_solid_angle(angle) == pytest.approx(rings, rel=1e-13)


def test_narrow_cones_keep_their_precision() -> None:
    angles = np.geomspace(1e-9, 1e-5, 9)
    assert_allclose(cone_solid_angle(angles), np.pi * angles**2, rtol=1e-10)


@given(st.floats(1e-7, np.pi - 1e-3))
def test_the_half_angle_of_a_cone_there_and_back(angle: float) -> None:
    assert cone_half_angle(cone_solid_angle(angle)) == pytest.approx(
        angle, rel=1e-9
    )


@given(st.floats(0.0, 2.0), st.floats(0.1, 1e6))
def test_a_cap_is_what_a_cone_cuts_off(height: float, radius: float) -> None:
    cone = cone_solid_angle(np.arccos(1.0 - height))
    cap = cap_solid_angle(height * radius, radius)
    assert cap == pytest.approx(cone, rel=1e-6, abs=1e-12)


def test_a_sphere_from_its_surface_and_from_afar() -> None:
    assert sphere_solid_angle(2.0, 2.0) == pytest.approx(2.0 * np.pi)
    distance = np.array([2.5, 10.0, 1e3])
    cone = cone_solid_angle(np.arcsin(2.0 / distance))
    assert_allclose(sphere_solid_angle(2.0, distance), cone, rtol=1e-12)
    # The sun, seen from the earth, in metres.
    sun = sphere_solid_angle(6.957e8, 1.495978707e11)
    assert sun == pytest.approx(6.79e-5, rel=1e-3)


@pytest.mark.parametrize("shape", [(1, 2), (3, 7), (64, 128), (1024, 2)])
def test_texels_of_an_equirectangular_map(shape: tuple[int, int]) -> None:
    angles = equirectangular_texel_solid_angles(*shape)
    assert angles.shape == shape
    assert angles.sum() == pytest.approx(SPHERE, rel=1e-12)
    # The rows down to a parallel are a cone around the pole.
    row = (shape[0] + 1) // 2
    cone = cone_solid_angle(row * np.pi / shape[0])
    assert angles[:row].sum() == pytest.approx(cone, rel=1e-12)


def test_texels_at_a_pole_keep_their_precision() -> None:
    height = 1 << 20
    first = equirectangular_texel_solid_angles(height, 4)[0, 0]
    cone = np.pi * (np.pi / height) ** 2
    assert 4.0 * first == pytest.approx(cone, rel=1e-11)


@pytest.mark.parametrize("size", [1, 2, 5, 64])
def test_texels_of_a_cube_map(size: int) -> None:
    angles = cube_texel_solid_angles(size)
    assert angles.shape == (size, size)
    assert 6.0 * angles.sum() == pytest.approx(SPHERE, rel=1e-12)
    assert_allclose(angles, angles.T, rtol=1e-9)
    assert_allclose(angles, angles[::-1, ::-1], rtol=1e-9)


@pytest.mark.parametrize("place", [(0, 0), (3, 5), (7, 7)])
def test_a_texel_of_a_cube_map_is_an_integral(place: tuple[int, int]) -> None:
    """A point (x, y) of the face is seen under cos t / d^2."""
    size = 8
    row, column = place
    edges = np.linspace(-1.0, 1.0, size + 1)

    def of_row(y: np.ndarray) -> np.ndarray:
        return np.array(
            [
                integral(
                    lambda x, y=value: (1.0 + x * x + y * y) ** -1.5,
                    edges[column],
                    edges[column + 1],
                )
                for value in y
            ]
        )

    expected = integral(of_row, edges[row], edges[row + 1])
    angle = cube_texel_solid_angles(size)[row, column]
    assert angle == pytest.approx(expected, rel=1e-12)
