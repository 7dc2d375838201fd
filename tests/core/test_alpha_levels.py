"""Levels of colours with alpha against means in float64."""

import math

import numpy as np
import pytest

from moka.core.alpha_levels import reduce_alpha_levels
from moka.core.colour import decode_srgb, encode_srgb
from tests.core.test_mip_levels import shrink


def noise(height: int, width: int, alphas: int = 256) -> np.ndarray:
    random = np.random.default_rng(height)
    texels = random.integers(0, 256, (height, width, 4), dtype=np.uint8)
    steps = random.integers(0, alphas, (height, width))
    texels[:, :, 3] = np.rint(255 * steps / (alphas - 1))
    return texels


def oracle(texels: np.ndarray) -> list[np.ndarray]:
    """Colours by weight, and alphas, from 0 to 1; nan where nothing is."""
    values = texels / 255.0
    values[:, :, :3] = decode_srgb(values[:, :, :3]) * values[:, :, 3:]
    levels = []
    while max(values.shape[:2]) > 1:
        values = shrink(shrink(values, 0), 1)
        with np.errstate(invalid="ignore"):
            colour = encode_srgb(values[:, :, :3] / values[:, :, 3:])
        levels.append(np.dstack([colour, values[:, :, 3]]))
    return levels


@pytest.mark.parametrize(
    "size", [(64, 64), (128, 2), (31, 20), (1, 7), (2048, 8)]
)
@pytest.mark.parametrize("alphas", [2, 256])
def test_colours_have_the_weight_of_their_alpha(
    size: tuple[int, int], alphas: int
) -> None:
    texels = noise(*size, alphas)
    levels = reduce_alpha_levels(texels)
    assert levels[0] is texels
    for level, exact in zip(levels[1:], oracle(texels), strict=True):
        assert level.shape == exact.shape
        assert level.dtype == np.uint8
        assert np.abs(level[:, :, 3] - 255 * exact[:, :, 3]).max() < 0.52
        # Where something is, an eighth of a code beside rounding.
        there = exact[:, :, 3] > 1 / 64
        difference = level[there] - 255 * exact[there]
        assert np.abs(difference).max() < 0.63


def test_what_is_transparent_does_not_bleed() -> None:
    """Green leaves on a transparent, red ground."""
    texels = np.full((16, 16, 4), (255, 0, 0, 0), np.uint8)
    texels[::3, ::2] = (0, 200, 0, 255)
    for level in reduce_alpha_levels(texels):
        seen = level[level[:, :, 3] > 0]
        assert len(seen)
        assert (np.abs(seen[:, :3].astype(int) - (0, 200, 0)) <= 1).all()


def test_colours_remain_where_all_is_transparent() -> None:
    """For what filters a texel of it together with others."""
    texels = np.full((8, 8, 4), (9, 80, 200, 0), np.uint8)
    for level in reduce_alpha_levels(texels, cutoff=0.5):
        assert (level == (9, 80, 200, 0)).all()


@pytest.mark.parametrize("cutoff", [0.1, 0.5, 0.9, 1.0])
def test_as_many_texels_reach_the_cutoff(cutoff: float) -> None:
    """To one texel of the level, whose mean alone would pass less or more."""
    texels = noise(64, 64)
    texels[:, :, 3] = texels[:, :, 3] // 3 + 170 * (texels[:, :, 3] > 200)
    covered = (texels[:, :, 3] >= 255 * cutoff).mean()
    kept = reduce_alpha_levels(texels, cutoff=cutoff)
    plain = reduce_alpha_levels(texels)
    lost = 0.0
    for level, mean in zip(kept[1:5], plain[1:5], strict=True):
        codes = level[:, :, 3]
        # What has the code of the cutoff itself passes together.
        least, wanted = math.ceil(255 * cutoff), covered * codes.size
        assert (codes >= least).sum() >= wanted - 0.5
        assert (codes > least).sum() <= wanted + 0.5
        without = (mean[:, :, 3] >= least).mean()
        lost = max(lost, abs(without - covered))
        assert (level[:, :, :3] == mean[:, :, :3]).all()
    assert lost > 0.05 or cutoff == 1.0


def test_nothing_and_everything_stay_so() -> None:
    texels = noise(16, 16)
    for value in (0, 100, 255):
        texels[:, :, 3] = value
        for level in reduce_alpha_levels(texels, cutoff=0.5):
            assert (level[:, :, 3] == value).all()


def test_levels_from_the_finest_wanted_on() -> None:
    texels = noise(32, 64)
    whole = reduce_alpha_levels(texels, cutoff=0.5)
    for finest in range(len(whole)):
        part = reduce_alpha_levels(texels, cutoff=0.5, finest=finest)
        assert len(part) == len(whole) - finest
        for level, same in zip(part, whole[finest:], strict=True):
            np.testing.assert_array_equal(level, same)
