"""Suns: found where they are, and nothing is lost by taking them out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.lighting.environment import Environment, Sun
from moka.lighting.suns import extract_suns, split_environment
from tests.support.oracles.environment import (
    equirectangular_directions,
    equirectangular_solid_angles,
)

HEIGHT, WIDTH = 64, 128


def sky(height: int = HEIGHT, seed: int = 1) -> np.ndarray:
    generator = np.random.default_rng(seed)
    shape = (height, 2 * height, 3)
    return generator.uniform(0.2, 1.8, shape).astype(np.float32)


def disc(
    pixels: np.ndarray, direction, radius: float, radiance: float
) -> np.ndarray:
    """``pixels`` with every texel near ``direction`` at ``radiance``."""
    height, width, _ = pixels.shape
    towards = np.asarray(direction, float) / np.linalg.norm(direction)
    cosine = equirectangular_directions(width, height) @ towards
    drawn = pixels.copy()
    drawn[np.arccos(np.clip(cosine, -1, 1)) <= radius] = radiance
    return drawn


def flux(pixels: np.ndarray) -> np.ndarray:
    height, width, _ = pixels.shape
    weights = equirectangular_solid_angles(width, height)
    return np.einsum("hw,hwc->c", weights, pixels.astype(np.float64))


def assert_nothing_is_lost(pixels, base, suns) -> None:
    total = flux(base) + np.sum([sun.irradiance for sun in suns], axis=0)
    assert total == pytest.approx(flux(pixels), rel=1e-6)


@given(
    row=st.integers(0, HEIGHT - 1),
    column=st.integers(0, WIDTH - 1),
    radiance=st.floats(2e4, 1e9),
)
def test_a_sun_of_one_texel(row, column, radiance):
    pixels = sky()
    pixels[row, column] = (radiance, 0.9 * radiance, 0.5 * radiance)
    base, suns = extract_suns(pixels)
    # At a pole a texel is a sliver: its flux may be too little for a sun.
    if not suns:
        area = equirectangular_solid_angles(WIDTH, HEIGHT)[row, 0]
        assert 0.8 * radiance * area < 0.02 * flux(pixels).mean()
        return
    (sun,) = suns
    assert_nothing_is_lost(pixels, base, suns)
    expected = equirectangular_directions(WIDTH, HEIGHT)[row, column]
    assert sun.direction == pytest.approx(expected, abs=1e-6)
    area = equirectangular_solid_angles(WIDTH, HEIGHT)[row, 0]
    assert sun.angular_radius == pytest.approx(np.sqrt(area * 2 / 3), rel=1e-3)
    changed = (base != pixels).any(axis=2)
    assert changed.sum() == 1


@pytest.mark.parametrize(
    ("direction", "radius"),
    [
        ((1, 0.5, 0.3), 0.02),
        ((-1, 0.2, 0.0), 0.02),  # on the seam
        ((-1, 0.2, 1e-3), 0.03),
        ((0, 1, 0), 0.02),  # at the poles
        ((0, -1, 0), 0.03),
        ((0.01, 1, 0.005), 0.02),
    ],
)
def test_a_sun_of_many_texels_is_one_wherever_it_stands(direction, radius):
    pixels = disc(sky(256), direction, radius, 1e5)
    base, suns = extract_suns(pixels)
    assert len(suns) == 1
    assert_nothing_is_lost(pixels, base, suns)
    unit = np.asarray(direction) / np.linalg.norm(direction)
    # Texels are 0.012 wide.
    assert np.linalg.norm(suns[0].direction - unit) < 0.004
    assert suns[0].angular_radius == pytest.approx(radius, abs=0.008)
    assert base.mean(axis=2).max() <= 8.0001 * flux(pixels).mean() / (4 * np.pi)


def test_several_suns_come_brightest_first():
    pixels = disc(sky(128), (1, 1, 0), 0.03, 2e4)
    pixels = disc(pixels, (-1, 1, 0), 0.03, 6e4)
    pixels = disc(pixels, (0, 1, -1), 0.03, 4e4)
    base, suns = extract_suns(pixels)
    assert_nothing_is_lost(pixels, base, suns)
    assert [np.sign(np.round(sun.direction, 2)).tolist() for sun in suns] == [
        [-1, 1, 0],
        [0, 1, -1],
        [1, 1, 0],
    ]
    base, suns = extract_suns(pixels, 1)
    assert [sun.direction[0] < -0.5 for sun in suns] == [True]
    assert_nothing_is_lost(pixels, base, suns)
    # The others are as they were.
    assert base.max() == pytest.approx(4e4)


def test_a_ragged_sun_is_one_component():
    """A spiral whose turns touch each other here and there."""
    pixels = sky(512)
    turn = np.linspace(2.0, 26.0, 2000)
    rows = np.round(256 + 0.19 * turn * np.sin(turn)).astype(int)
    columns = np.round(100 + 0.19 * turn * np.cos(turn)).astype(int)
    pixels[rows, columns] = 1e5
    base, suns = extract_suns(pixels)
    assert len(suns) == 1
    assert (base != pixels).any(axis=2).sum() == (pixels == 1e5).all(2).sum()
    assert_nothing_is_lost(pixels, base, suns)


def test_the_glare_around_a_sun_goes_with_it():
    directions = equirectangular_directions(1024, 512)
    towards = np.array([0.6, 0.8, 0.0])
    angle = np.arccos(np.clip(directions @ towards, -1.0, 1.0))
    glare = 5e4 / (1.0 + (angle / 0.006) ** 4)
    pixels = sky(512) + glare[..., None].astype(np.float32)
    base, suns = extract_suns(pixels)
    assert len(suns) == 1
    assert suns[0].angular_radius < 0.02
    assert_nothing_is_lost(pixels, base, suns)


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((32, 64, 3), np.float32),
        np.ones((32, 64, 3), np.float32),
        np.full((1, 2, 3), 7.0, np.float32),
        sky(),
        # A soft box: a quarter of the light from 0.05 steradians.
        disc(sky(128), (1, 0.3, 0), 0.126, 90.0),
        # A window with much of the light.
        disc(sky(128), (1, 0.3, 0), 0.2, 2000.0),
        # A bright spot that hardly shines.
        disc(sky(512), (1, 0.3, 0), 0.004, 400.0),
    ],
    ids=["black", "white", "two texels", "noise", "box", "window", "spot"],
)
def test_what_is_no_sun_stays_in_the_map(pixels):
    base, suns = extract_suns(pixels)
    assert suns == ()
    assert base is pixels


def test_a_blue_lamp_is_seen():
    pixels = sky(128)
    pixels[40, 70] = (0.0, 0.0, 1e6)
    base, (lamp,) = extract_suns(pixels)
    assert lamp.irradiance[0] == lamp.irradiance[1] == 0.0
    assert_nothing_is_lost(pixels, base, [lamp])


def test_suns_that_are_off_are_in_the_map():
    sun = Sun((0.6, 0.8, 0.0), (3.0, 2.0, 1.0), 0.02)
    environment = Environment(sky(128), (sun,))
    split = split_environment(environment, 0)
    assert split.suns == ()
    assert split.base is split.full
    added = flux(split.full) - flux(environment.pixels)
    assert added == pytest.approx(sun.irradiance, rel=1e-5)


def test_the_suns_of_an_environment_are_lights_and_not_in_its_map():
    sun = Sun((0.6, 0.8, 0.0), (3.0, 2.0, 1.0), 0.005)
    environment = Environment(sky(), (sun,))
    split = split_environment(environment)
    assert split.suns == (sun,)
    assert not sun.in_map
    assert split.base is split.full is environment.pixels


def test_own_suns_are_first_and_found_ones_fill_up():
    pixels = disc(sky(128), (-1, 1, 0), 0.03, 6e4)
    own = Sun((0.6, 0.8, 0.0), (0.03, 0.02, 0.01), 0.005)
    environment = Environment(pixels, (own,))
    first, found = split_environment(environment).suns
    assert first == own
    assert found.in_map
    assert split_environment(environment, search=False).suns == (own,)
    assert split_environment(environment, 1).suns == (own,)


def test_a_uniform_environment_becomes_a_map_to_show_suns_that_are_off():
    sun = Sun((0.0, 1.0, 0.0), (3.0, 2.0, 1.0))
    environment = Environment(np.ones((1, 1, 3), np.float32), (sun,))
    split = split_environment(environment, 0)
    assert split.suns == ()
    added = flux(split.full) - flux(np.ones_like(split.full))
    assert added == pytest.approx(sun.irradiance, rel=1e-5)


def test_a_uniform_environment_with_a_light_stays_one_texel():
    sun = Sun((0.0, 1.0, 0.0), (3.0, 2.0, 1.0))
    environment = Environment(np.ones((1, 1, 3), np.float32), (sun,))
    split = split_environment(environment)
    assert split.suns == (sun,)
    assert split.full.shape == (1, 1, 3)


def test_a_uniform_environment_without_suns_stays_one_texel():
    split = split_environment(Environment.uniform((1.0, 1.0, 1.0)))
    assert split.base.shape == (1, 1, 3)


@pytest.mark.assets
@pytest.mark.parametrize(
    ("name", "count"),
    [("spiaggia_di_mondello_1k.hdr", 1), ("f3d_default.hdr", 0)],
)
def test_real_maps(assets, name, count):
    from moka.lighting.environment import load_environment

    environment = load_environment(assets / "environments" / name)
    split = split_environment(environment)
    assert len(split.suns) == count
    assert_nothing_is_lost(split.full, split.base, split.suns)
    if count:
        # Half of the light, from half a degree.
        share = np.sum(split.suns[0].irradiance) / flux(split.full).sum()
        assert 0.4 < share < 0.6
        assert np.degrees(split.suns[0].angular_radius) < 1.0
