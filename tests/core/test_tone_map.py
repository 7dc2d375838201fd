"""The curves against their published form, one pixel at a time."""

import math

import numpy as np
import pytest

from moka.core.errors import OptionError
from moka.core.tone_map import TONE_MAPS, tone_map

RADIANCE = np.concatenate(
    [
        np.random.default_rng(7).uniform(0.0, 1.0, (200, 3)) ** 4 * 20.0,
        np.repeat(np.geomspace(1e-4, 1e4, 60)[:, np.newaxis], 3, axis=1),
        np.eye(3) * 0.5,
        np.eye(3) * 50.0,
        [[0.0, 0.0, 0.0], [0.8, 0.8, 0.8], [0.08, 0.2, 0.4]],
    ]
)


def neutral_pixel(colour: np.ndarray) -> np.ndarray:
    x = colour.min()
    colour = colour - (x - 6.25 * x * x if x < 0.08 else 0.04)
    peak = colour.max()
    if peak < 0.76:
        return colour
    d = 1.0 - 0.76
    new_peak = 1.0 - d * d / (peak + d - 0.76)
    colour = colour * new_peak / peak
    g = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0)
    return (1.0 - g) * colour + g * new_peak


def aces_pixel(colour: np.ndarray) -> np.ndarray:
    r, g, b = colour
    v = [
        0.59719 * r + 0.35458 * g + 0.04823 * b,
        0.07600 * r + 0.90834 * g + 0.01566 * b,
        0.02840 * r + 0.13383 * g + 0.83777 * b,
    ]
    r, g, b = (
        (c * (c + 0.0245786) - 0.000090537)
        / (c * (0.983729 * c + 0.4329510) + 0.238081)
        for c in v
    )
    return np.array(
        [
            1.60475 * r - 0.53108 * g - 0.07367 * b,
            -0.10208 * r + 1.10813 * g - 0.00605 * b,
            -0.00327 * r - 0.07276 * g + 1.07602 * b,
        ]
    )


def agx_pixel(colour: np.ndarray) -> np.ndarray:
    r, g, b = colour
    inset = [
        0.842479062253094 * r + 0.0784335999999992 * g + 0.0792237451477643 * b,
        0.0423282422610123 * r + 0.878468636469772 * g + 0.0791661274605434 * b,
        0.0423756549057051 * r + 0.0784336 * g + 0.879142973793104 * b,
    ]
    sigmoid = []
    for c in inset:
        stops = math.log2(c) if c > 0.0 else -math.inf
        x = (min(max(stops, -12.47393), 4.026069) + 12.47393) / 16.499999
        sigmoid.append(
            15.5 * x**6
            - 40.14 * x**5
            + 31.96 * x**4
            - 6.868 * x**3
            + 0.4298 * x**2
            + 0.1191 * x
            - 0.00232
        )
    r, g, b = sigmoid
    display = [
        1.19687900512017 * r - 0.0980208811401368 * g - 0.0990297440797205 * b,
        -0.0528968517574562 * r + 1.15190312990417 * g - 0.0989611768448433 * b,
        -0.0529716355144438 * r - 0.0980434501171241 * g + 1.15107367264116 * b,
    ]
    return np.array([max(c, 0.0) ** 2.2 for c in display])


ORACLES = {
    "neutral": neutral_pixel,
    "aces": aces_pixel,
    "agx": agx_pixel,
    "reinhard": lambda colour: colour / (1.0 + colour),
    "exponential": lambda colour: 1.0 - np.exp(-colour),
    "none": lambda colour: colour,
}


def test_every_curve_of_the_contract_is_there() -> None:
    assert set(TONE_MAPS) == set(ORACLES)


@pytest.mark.parametrize("name", TONE_MAPS)
def test_curve_is_the_published_one(name: str) -> None:
    expected = [ORACLES[name](colour) for colour in RADIANCE]
    np.testing.assert_allclose(
        tone_map(RADIANCE, name), np.clip(expected, 0.0, 1.0), atol=1e-12
    )


@pytest.mark.parametrize("name", TONE_MAPS)
def test_single_precision_is_enough(name: str) -> None:
    result = tone_map(RADIANCE.astype(np.float32), name)
    assert result.dtype == np.float32
    np.testing.assert_allclose(result, tone_map(RADIANCE, name), atol=2e-5)


@pytest.mark.parametrize("name", TONE_MAPS)
def test_grey_stays_in_order(name: str) -> None:
    grey = np.geomspace(1e-4, 100.0, 500)[:, np.newaxis].repeat(3, axis=1)
    mapped = tone_map(grey, name)
    assert (np.diff(mapped, axis=0) >= 0.0).all()
    np.testing.assert_allclose(mapped[:, 0], mapped[:, 1], atol=2e-3)
    assert (mapped[0] < 0.001).all()
    assert (mapped[-1] > 0.95).all()


@pytest.mark.parametrize("name", TONE_MAPS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("exposure", [-5000.0, 2.0, 5000.0])
def test_no_input_becomes_nan(name: str, dtype: type, exposure: float) -> None:
    extremes = [math.nan, math.inf, -math.inf, -1.0, 0.0, 1e-45, 1e30]
    radiance = np.array([[a, b, 0.5] for a in extremes for b in extremes])
    mapped = tone_map(radiance.astype(dtype), name, exposure)
    assert np.isfinite(mapped).all()
    assert mapped.min() >= 0.0
    assert mapped.max() <= 1.0


def test_exposure_counts_in_stops() -> None:
    for name in TONE_MAPS:
        np.testing.assert_allclose(
            tone_map(RADIANCE, name, exposure=-1.5),
            tone_map(RADIANCE * 2.0**-1.5, name),
            atol=1e-12,
        )


def test_images_keep_their_shape() -> None:
    for name in TONE_MAPS:
        assert tone_map(np.ones((2, 5, 3)), name).shape == (2, 5, 3)


def test_unknown_curve_names_the_known_ones() -> None:
    with pytest.raises(OptionError, match=r"'filmic'.*neutral, aces"):
        tone_map(RADIANCE, "filmic")
