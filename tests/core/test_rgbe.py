"""RGBE pixels against their definition."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from moka.core.rgbe import decode_rgbe, encode_rgbe

byte = st.integers(0, 255)


@given(byte, byte, byte, byte)
def test_decode_is_mantissa_times_power(
    red: int, green: int, blue: int, exponent: int
) -> None:
    colour = decode_rgbe(np.array([red, green, blue, exponent], np.uint8))
    expected = [
        math.ldexp(mantissa, exponent - 136) if exponent else 0.0
        for mantissa in (red, green, blue)
    ]
    assert colour.dtype == np.float32
    assert colour.tolist() == expected


@given(byte, byte, st.integers(128, 255), st.integers(1, 255))
def test_encode_undoes_decode(
    red: int, green: int, blue: int, exponent: int
) -> None:
    rgbe = np.array([red, green, blue, exponent], np.uint8)
    assert encode_rgbe(decode_rgbe(rgbe)).tolist() == rgbe.tolist()


@given(st.lists(st.floats(0.0, 1e30), min_size=3, max_size=3))
def test_encode_is_off_by_half_a_mantissa(colour: list[float]) -> None:
    decoded = decode_rgbe(encode_rgbe(np.array(colour)))
    step = math.ldexp(1.0, math.frexp(max(colour))[1] - 8)
    # Once more as much where the mantissa rounds up to the next exponent.
    tolerance = max(step, math.ldexp(1.0, -135))
    np.testing.assert_allclose(decoded, colour, atol=tolerance, rtol=1e-7)


def test_nearest_mantissa_is_chosen() -> None:
    assert encode_rgbe(np.array([1.0, 0.5, 0.0])).tolist() == [128, 64, 0, 129]
    below_two = np.array([2.0 - 1e-6, 0.0, 0.0])
    assert encode_rgbe(below_two).tolist() == [128, 0, 0, 130]


def test_what_the_format_cannot_hold() -> None:
    colours = np.array(
        [
            [0.0, 0.0, 0.0],
            [-1.0, math.nan, -math.inf],
            [1e-40, 0.0, 0.0],
            [math.inf, 1e39, 0.0],
            # Nearer to the least that there is than to nothing.
            [0.999 * 2.0**-128, 0.0, 0.0],
        ]
    )
    assert encode_rgbe(colours).tolist() == [
        [0, 0, 0, 0],
        [0, 0, 0, 0],
        [0, 0, 0, 0],
        [255, 255, 0, 255],
        [128, 0, 0, 1],
    ]


def test_large_images_are_encoded_as_their_pixels_are() -> None:
    random = np.random.default_rng(1)
    exponents = random.uniform(-140, 127, (130, 97, 3))
    colours = np.exp2(exponents).astype(np.float32)
    whole = encode_rgbe(colours)
    assert whole.shape == (130, 97, 4)
    for row, column in ((0, 0), (84, 44), (84, 45), (129, 96)):
        alone = encode_rgbe(colours[row, column])
        assert whole[row, column].tolist() == alone.tolist()
    assert encode_rgbe(colours[:, ::-1]).tolist() == whole[:, ::-1].tolist()
