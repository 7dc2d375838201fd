"""The sRGB curve against its definition, exactly where it is rounded."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.core.colour import (
    decode_srgb,
    decode_srgb8,
    encode_srgb,
    encode_srgb8,
    luminance,
    parse_hex_colour,
)
from moka.core.errors import OptionError


def encoded(value: float) -> float:
    """IEC 61966-2-1 for one value of 0..1."""
    if value <= 0.0031308:
        return 12.92 * value
    return 1.055 * value ** (1.0 / 2.4) - 0.055


@given(st.floats(0.0, 1.0))
def test_encode_is_the_piecewise_curve(value: float) -> None:
    assert encode_srgb(value) == pytest.approx(encoded(value), abs=1e-15)


@given(st.floats(0.0, 1.0))
def test_decode_undoes_encode(value: float) -> None:
    assert decode_srgb(encode_srgb(value)) == pytest.approx(value, abs=1e-7)


def test_float32_stays_float32() -> None:
    values = np.linspace(0.0, 1.0, 11, dtype=np.float32)
    assert encode_srgb(values).dtype == np.float32
    assert decode_srgb(values).dtype == np.float32
    assert encode_srgb(values.astype(np.float16)).dtype == np.float64


@given(st.floats(0.0, 1.0, width=32))
def test_eight_bits_round_the_exact_curve(value: float) -> None:
    assert encode_srgb8(value) == math.floor(255.0 * encoded(value) + 0.5)


def test_eight_bits_change_at_the_right_float() -> None:
    halfway = decode_srgb((np.arange(255) + 0.5) / 255.0)
    nearest = halfway.astype(np.float32).view(np.int32)
    for offset in range(-2, 3):
        values = (nearest + np.int32(offset)).view(np.float32)
        expected = np.floor(255.0 * encode_srgb(values.astype(float)) + 0.5)
        np.testing.assert_array_equal(encode_srgb8(values), expected)


def test_eight_bits_of_what_is_out_of_range() -> None:
    values = [-1.0, -0.0, 1.5, math.inf, -math.inf, math.nan]
    assert encode_srgb8(values).tolist() == [0, 0, 255, 255, 0, 0]


def test_eight_bits_of_arrays_beyond_one_block() -> None:
    values = np.linspace(0.0, 1.0, 90_000).reshape(300, 100, 3)
    codes = encode_srgb8(values)
    assert codes.shape == values.shape
    expected = 255.0 * encode_srgb(values.astype(np.float32).astype(float))
    np.testing.assert_array_equal(codes, np.floor(expected + 0.5))


def test_every_code_survives_a_round_trip() -> None:
    codes = np.arange(256, dtype=np.uint8)
    np.testing.assert_array_equal(encode_srgb8(decode_srgb8(codes)), codes)
    np.testing.assert_allclose(
        decode_srgb8(codes), decode_srgb(codes / 255.0), rtol=1e-7
    )


def test_luminance_is_that_of_rec709() -> None:
    colours = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    np.testing.assert_allclose(luminance(colours), [[0.2126, 0.7152]])
    assert luminance([2.0, 2.0, 2.0]) == pytest.approx(2.0)


def test_hexadecimal_colours_are_srgb_encoded() -> None:
    assert parse_hex_colour("#000000") == (0.0, 0.0, 0.0)
    assert parse_hex_colour("#FFffFF") == (1.0, 1.0, 1.0)
    red, green, blue = parse_hex_colour("#ff8000")
    assert (red, blue) == (1.0, 0.0)
    assert encoded(green) == pytest.approx(128 / 255)


@pytest.mark.parametrize(
    "text", ["", "#fff", "ffffff", "#ggffff", "#ffffff0", "#ffffff\n", "white"]
)
def test_other_forms_of_colour_are_refused(text: str) -> None:
    with pytest.raises(OptionError, match="#rrggbb"):
        parse_hex_colour(text)
