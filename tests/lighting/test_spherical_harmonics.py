"""Nine coefficients against irradiance by quadrature."""

import numpy as np
import pytest

from moka.lighting.environment import load_environment
from moka.lighting.spherical_harmonics import (
    evaluate,
    irradiance_error,
    irradiance_harmonics,
)
from moka.lighting.suns import split_environment
from tests.support.oracles.directions import random_directions
from tests.support.oracles.environment import (
    equirectangular_directions,
    equirectangular_solid_angles,
    irradiance_over_pi,
)


def low_bands(directions: np.ndarray) -> np.ndarray:
    """Radiance that has every harmonic of bands 0, 1 and 2, and no other."""
    x, y, z = np.moveaxis(directions, -1, 0)
    red = 3.0 + 0.5 * x - 0.4 * y + 0.3 * z
    green = 3.0 + 0.7 * x * y - 0.2 * y * z + 0.4 * x * z
    blue = 3.0 + 0.3 * (3.0 * z * z - 1.0) - 0.6 * (x * x - y * y)
    return np.stack((red, green, blue), axis=-1)


def exact(pixels: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """E / pi of a map as it is: each texel counts as its centre."""
    height, width, _ = pixels.shape
    directions = equirectangular_directions(width, height).reshape(-1, 3)
    weights = equirectangular_solid_angles(width, height).reshape(-1, 1)
    cosines = np.maximum(normals @ directions.T, 0.0)
    return cosines @ (weights * pixels.reshape(-1, 3)) / np.pi


@pytest.mark.parametrize("height", [64, 100, 256])
def test_light_of_three_bands_is_exact(height):
    directions = equirectangular_directions(2 * height, height)
    pixels = low_bands(directions).astype(np.float32)
    normals = random_directions(100, 1, -1.0)
    expected = irradiance_over_pi(low_bands, normals)
    value = evaluate(irradiance_harmonics(pixels), normals)
    assert np.abs(value - expected).max() < 2e-3
    assert irradiance_error(pixels, irradiance_harmonics(pixels)) < 4e-3


def test_irradiance_of_one_texel_is_uniform():
    pixels = np.full((1, 1, 3), 2.5, np.float32)
    coefficients = irradiance_harmonics(pixels)
    values = evaluate(coefficients, random_directions(50, 2, -1.0))
    assert values == pytest.approx(2.5, rel=2e-4)
    assert irradiance_error(pixels, coefficients) < 3e-3


@pytest.mark.parametrize("seed", range(3))
def test_the_error_is_what_quadrature_finds(seed):
    generator = np.random.default_rng(seed)
    pixels = np.full((64, 128, 3), 0.3, np.float32)
    for _ in range(4):
        row, column = generator.integers(0, 50), generator.integers(0, 110)
        pixels[row : row + 12, column : column + 16] = generator.uniform(1, 9)
    coefficients = irradiance_harmonics(pixels)
    normals = random_directions(500, seed, -1.0)
    truth = exact(pixels, normals)
    error = np.abs(evaluate(coefficients, normals) - truth) / truth.mean(axis=0)
    estimate = irradiance_error(pixels, coefficients)
    assert estimate == pytest.approx(error.max(), rel=0.3)


def test_a_lamp_in_the_dark_takes_no_light_away():
    pixels = np.zeros((64, 128, 3), np.float32)
    pixels[10:14, 30:34] = 1e3
    values = evaluate(
        irradiance_harmonics(pixels), random_directions(500, 4, -1.0)
    )
    assert values.min() == 0.0


def test_darkness_has_no_error():
    pixels = np.zeros((64, 128, 3), np.float32)
    assert irradiance_error(pixels, irradiance_harmonics(pixels)) == 0.0


@pytest.mark.assets
def test_taking_the_sun_out_is_what_makes_nine_coefficients_suffice(assets):
    environment = load_environment(
        assets / "environments" / "spiaggia_di_mondello_1k.hdr"
    )
    split = split_environment(environment)
    whole = irradiance_error(split.full, irradiance_harmonics(split.full))
    base = irradiance_error(split.base, irradiance_harmonics(split.base))
    assert whole > 0.15
    assert base < 0.035
