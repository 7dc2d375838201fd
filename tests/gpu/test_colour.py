"""sRGB and tone maps in GLSL against their twins for arrays."""

import numpy as np
import pytest

from moka.core.colour import decode_srgb, encode_srgb
from moka.core.tone_map import TONE_MAPS, tone_map
from tests.support.gpu import gpu

pytestmark = pytest.mark.gpu

# Below half of an 8-bit step by a factor of 500.
TOLERANCE = 4e-6

# Of a pass that shows none, its block without suns.
NO_SKY = bytes(80)


def greys(values: np.ndarray) -> np.ndarray:
    return np.repeat(values[:, None], 3, axis=1)


def radiances() -> np.ndarray:
    """Colours over 12 decades, with black, negatives and a sun."""
    generator = np.random.default_rng(1)
    hue = generator.uniform(0.0, 1.0, (4000, 3))
    colours = hue * 10.0 ** generator.uniform(-7.0, 5.0, (4000, 1))
    special = [[0, 0, 0], [-1, -0.5, 2], [1, 1, 1], [1e30, 0, 1], [1e9] * 3]
    return np.concatenate((colours, special)).astype(np.float32)


def test_srgb_encoding():
    x = np.concatenate((np.linspace(0, 1, 4001), [0.0031308, 0.0031309]))
    encoded = gpu().evaluate("srgb_encode(x)", "srgb", x=greys(x))
    assert np.abs(encoded - encode_srgb(greys(x))).max() < TOLERANCE


def test_srgb_decoding():
    x = np.concatenate((np.linspace(0, 1, 4001), [0.04045, 0.040451]))
    decoded = gpu().evaluate("srgb_decode(x)", "srgb", x=greys(x))
    assert np.abs(decoded - decode_srgb(greys(x))).max() < TOLERANCE


def test_every_eight_bit_code_survives_the_way_there_and_back():
    codes = np.arange(256) / 255.0
    back = gpu().evaluate("srgb_encode(srgb_decode(x))", "srgb", x=greys(codes))
    assert np.array_equal(np.rint(back * 255.0), greys(np.arange(256)))


def test_negative_light_encodes_as_black():
    assert (
        not gpu().evaluate("srgb_encode(x)", "srgb", x=[[-1, -1e-9, 0]]).any()
    )


@pytest.mark.parametrize("name", TONE_MAPS)
def test_tone_maps_equal_their_twins(name):
    x = radiances()
    defines = {f"MOKA_TONE_MAP_{name.upper()}": 1}
    mapped = gpu().evaluate("tone_map(x)", "tone_map", defines, x=x)
    assert np.isfinite(mapped).all()
    expected = tone_map(x.astype(np.float64), name)
    # AgX takes a logarithm and ends in a power: float32 keeps fewer digits.
    assert np.abs(mapped - expected).max() < (1e-4 if name == "agx" else 1e-5)


@pytest.mark.parametrize("name", TONE_MAPS)
@pytest.mark.parametrize("gamma", [None, 2.2])
def test_the_pass_exposes_maps_and_encodes(name, gamma):
    radiance = radiances()[:4000].reshape(40, 100, 3)
    alpha = np.linspace(0.0, 1.0, 4000).reshape(40, 100, 1)
    texels = np.concatenate((radiance * alpha, alpha), axis=-1)
    defines = {"MOKA_DISPLAY": 1, f"MOKA_TONE_MAP_{name.upper()}": 1}
    if gamma:
        defines["MOKA_ENCODE_GAMMA"] = 1
    block = np.zeros((2, 4), np.float32)
    block[0, :2] = 2.0**1.5, 1.0 / (gamma or 1.0)
    picture = gpu().draw(
        "tone_map.frag",
        (100, 40),
        vertex="screen.vert",
        defines=defines,
        textures={"radiance_map": gpu().texture(texels)},
        blocks={"ToneMap": block.tobytes(), "Background": NO_SKY},
    )
    display = tone_map(radiance.astype(np.float64), name, 1.5)
    code = display ** (1.0 / gamma) if gamma else encode_srgb(display)
    code[alpha[..., 0] == 0.0] = 0.0
    # Near black a power curve magnifies rounding; 8 bits do not see it.
    assert np.abs(picture[..., :3] - code).max() < 1e-3
    assert np.abs(picture[..., 3:] - alpha).max() < 1e-6


def test_a_background_colour_leaves_as_it_was_given():
    """Neither exposed nor tone mapped, and covered by what is in front."""
    behind = np.array([0.2, 0.4, 0.6])
    texels = np.array([[[0, 0, 0, 0], [0.25, 0.25, 0.25, 0.5], [1, 0, 0, 1]]])
    block = np.array([[4, 1, 0, 0], [*behind, 0]], np.float32)
    picture = gpu().draw(
        "tone_map.frag",
        (3, 1),
        vertex="screen.vert",
        defines={"MOKA_DISPLAY": 1, "MOKA_BACKGROUND_COLOUR": 1},
        textures={"radiance_map": gpu().texture(texels)},
        blocks={"ToneMap": block.tobytes(), "Background": NO_SKY},
    )
    # Exposed by two stops, 0.5 becomes 1 and half of the pixel.
    light = np.array([behind, 0.5 * behind + 0.5, [1.0, 0.0, 0.0]])
    assert np.abs(picture[0, :, :3] - encode_srgb(light)).max() < TOLERANCE
    assert (picture[..., 3] == 1.0).all()
