"""The map's directions and solid angles against the contract's formulas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.lighting.equirectangular import (
    direction_to_uv,
    mean_radiance,
    solid_angles,
    texel_directions,
    uv_to_direction,
)

AXES = {
    (1, 0, 0): (0.5, 0.5),
    (0, 0, 1): (0.75, 0.5),
    (0, 0, -1): (0.25, 0.5),
    (0, 1, 0): (None, 0.0),
    (0, -1, 0): (None, 1.0),
}


@pytest.mark.parametrize(("direction", "uv"), AXES.items())
def test_axes_lie_where_the_contract_says(
    direction: tuple[int, int, int], uv: tuple[float | None, float]
) -> None:
    u, v = direction_to_uv(direction)
    assert v == pytest.approx(uv[1])
    if uv[0] is not None:
        assert u == pytest.approx(uv[0])


def test_back_of_the_map_is_its_seam() -> None:
    assert direction_to_uv([-1, 0, 1e-9])[0] == pytest.approx(1.0)
    assert direction_to_uv([-1, 0, -1e-9])[0] == pytest.approx(0.0, abs=1e-9)


@given(st.floats(0.001, 0.999), st.floats(0.001, 0.999))
def test_there_and_back(u: float, v: float) -> None:
    direction = uv_to_direction([u, v])
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    np.testing.assert_allclose(direction_to_uv(3.0 * direction), [u, v])
    x, y, z = direction
    assert u == pytest.approx(0.5 + math.atan2(z, x) / (2.0 * math.pi))
    assert v == pytest.approx(math.acos(y) / math.pi)


def test_texels_are_seen_through_their_centres() -> None:
    directions = texel_directions(3, 7)
    assert directions.shape == (3, 7, 3)
    for row in range(3):
        for column in range(7):
            np.testing.assert_allclose(
                directions[row, column],
                uv_to_direction([(column + 0.5) / 7, (row + 0.5) / 3]),
                atol=1e-15,
            )


@pytest.mark.parametrize("size", [(1, 1), (1, 2), (5, 10), (512, 1024)])
def test_solid_angles_make_a_sphere(size: tuple[int, int]) -> None:
    angles = solid_angles(*size)
    assert angles.shape == size
    assert angles.sum() == pytest.approx(4.0 * math.pi, rel=1e-12)
    assert angles.min() > 0.0


def test_solid_angle_is_the_integral_of_the_sine() -> None:
    angles = solid_angles(4, 8)
    polar = (np.arange(40_000) + 0.5) / 40_000 * math.pi / 4
    integral = np.sin(polar).mean() * math.pi / 4 * (2 * math.pi / 8)
    assert angles[0, 0] == pytest.approx(integral, rel=1e-7)


def test_mean_weighs_by_solid_angle() -> None:
    pixels = np.random.default_rng(0).uniform(size=(6, 12, 3))
    expected = (pixels * solid_angles(6, 12)[:, :, None]).sum((0, 1))
    np.testing.assert_allclose(mean_radiance(pixels), expected / (4 * math.pi))
    np.testing.assert_allclose(mean_radiance(np.ones((4, 8, 3))), 1.0)
