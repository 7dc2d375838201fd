"""The sky against the formulas of Preetham et al., one direction at a time."""

import math

import numpy as np
import pytest

from moka.core.colour import luminance
from moka.lighting.equirectangular import (
    mean_radiance,
    solid_angles,
    texel_directions,
)
from moka.lighting.sky import sky

SUN_ANGLE = math.radians(50.0)
TURBIDITY = 4.0


def perez(coefficients: tuple[float, ...], theta: float, gamma: float) -> float:
    a, b, c, d, e = coefficients
    return (1 + a * math.exp(b / math.cos(theta))) * (
        1 + c * math.exp(d * gamma) + e * math.cos(gamma) ** 2
    )


def luminance_oracle(theta: float, gamma: float) -> float:
    """kcd per square metre: appendix A.2 for turbidity 4."""
    t = TURBIDITY
    coefficients = (
        0.1787 * t - 1.4630,
        -0.3554 * t + 0.4275,
        -0.0227 * t + 5.3251,
        0.1206 * t - 2.5771,
        -0.0670 * t + 0.3703,
    )
    chi = (4 / 9 - t / 120) * (math.pi - 2 * SUN_ANGLE)
    zenith = (4.0453 * t - 4.9710) * math.tan(chi) - 0.2155 * t + 2.4192
    return (
        zenith
        * perez(coefficients, theta, gamma)
        / perez(coefficients, 0.0, SUN_ANGLE)
    )


def test_luminance_follows_the_formula() -> None:
    environment = sky(math.pi / 2 - SUN_ANGLE, 0.7, TURBIDITY)
    height, width, _ = environment.pixels.shape
    directions = texel_directions(height, width)
    sun = np.array(environment.suns[0].direction)
    random = np.random.default_rng(0)
    rows = random.integers(0, height // 2 - 2, 40)
    columns = random.integers(0, width, 40)
    # The map is in relative units: compare up to one factor.
    ratios = []
    for row, column in zip(rows, columns, strict=True):
        direction = directions[row, column]
        theta = math.acos(direction[1])
        gamma = math.acos(direction @ sun)
        value = float(luminance(environment.pixels[row, column]))
        ratios.append(value / luminance_oracle(theta, gamma))
    np.testing.assert_allclose(ratios, ratios[0], rtol=2e-3)


def test_zenith_has_the_chromaticity_of_the_formula() -> None:
    environment = sky(math.pi / 2 - SUN_ANGLE, 0.0, TURBIDITY)
    powers = np.array([SUN_ANGLE**3, SUN_ANGLE**2, SUN_ANGLE, 1.0])
    t = np.array([TURBIDITY**2, TURBIDITY, 1.0])
    x = t @ [
        [0.00166, -0.00375, 0.00209, 0.0] @ powers,
        [-0.02903, 0.06377, -0.03202, 0.00394] @ powers,
        [0.11693, -0.21196, 0.06052, 0.25886] @ powers,
    ]
    rec709_to_xyz = np.array(
        [
            [0.4124, 0.3576, 0.1805],
            [0.2126, 0.7152, 0.0722],
            [0.0193, 0.1192, 0.9505],
        ]
    )
    xyz = rec709_to_xyz @ environment.pixels[0].mean(axis=0)
    assert xyz[0] / xyz.sum() == pytest.approx(x, abs=2e-3)


def test_white_surface_outdoors_needs_no_exposure() -> None:
    environment = sky()
    height, width, _ = environment.pixels.shape
    directions = texel_directions(height, width)
    cosines = np.maximum(directions[:, :, 1], 0.0) * solid_angles(height, width)
    irradiance = (environment.pixels * cosines[:, :, None]).sum((0, 1))
    [sun] = environment.suns
    irradiance += np.array(sun.irradiance) * sun.direction[1]
    assert luminance(irradiance) / math.pi == pytest.approx(1.4, rel=1e-3)


def test_sky_is_blue_and_of_moderate_range() -> None:
    pixels = sky().pixels
    assert np.isfinite(pixels).all()
    assert pixels.min() > 0.0
    # The sun is a light, and not in the map.
    assert pixels.max() < 10.0 * mean_radiance(pixels).max()
    red, _, blue = mean_radiance(np.concatenate([pixels[:128]] * 2))
    assert blue > 1.2 * red


def test_ground_meets_the_sky_without_an_edge() -> None:
    pixels = sky().pixels
    horizon = len(pixels) // 2
    step = np.abs(pixels[horizon] - pixels[horizon - 1])
    assert (step < 0.3 * pixels[horizon - 1]).all()
    assert np.abs(np.diff(pixels[-1], axis=0)).max() < 1e-5


def test_sun_stands_where_it_was_asked_for_and_reddens() -> None:
    low = sky(math.radians(3.0), math.radians(90.0)).suns[0]
    np.testing.assert_allclose(
        low.direction,
        [0.0, math.sin(math.radians(3.0)), math.cos(math.radians(3.0))],
        atol=1e-12,
    )
    high = sky(math.radians(80.0), 0.0).suns[0]
    for sun in (low, high):
        assert min(sun.irradiance) > 0.0
    assert low.irradiance[0] / low.irradiance[2] > 3.0
    assert high.irradiance[0] / high.irradiance[2] < 1.4
    assert low.angular_radius == pytest.approx(math.radians(0.2665))


def test_sun_below_the_horizon_is_refused() -> None:
    with pytest.raises(ValueError, match="horizon"):
        sky(-0.1)
