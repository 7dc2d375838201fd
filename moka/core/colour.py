"""Colour: the sRGB curve, hexadecimal colours, luminance.

moka computes in linear Rec.709. The sRGB encoding shares its primaries, so
that only the transfer curve stands between the two (IEC 61966-2-1). It is
the exact piecewise curve everywhere, never a power of 2.2.
"""

import re
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError

__all__ = [
    "LUMINANCE_WEIGHTS",
    "XYZ_TO_REC709",
    "decode_srgb",
    "decode_srgb8",
    "encode_srgb",
    "encode_srgb8",
    "luminance",
    "parse_hex_colour",
]

#: Rec. ITU-R BT.709, item 3.2: the share of each primary in the luminance.
LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)

#: CIE XYZ to linear Rec.709, a (3, 3) matrix for columns, from the
#: primaries and the white D65 of Rec. ITU-R BT.709, item 1.
XYZ_TO_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)

#: Elements worked on at a time, so that temporaries stay in the cache.
_BLOCK = 1 << 15


def encode_srgb(linear: ArrayLike) -> NDArray[np.floating[Any]]:
    """Linear values to sRGB (IEC 61966-2-1); 0..1 becomes 0..1.

    Any shape; float32 stays float32, everything else becomes float64.
    Values below 0 follow the linear segment, values above 1 the power.
    """
    values = _as_float(linear)
    power = 1.055 * np.maximum(values, 0.0) ** (1 / 2.4) - 0.055
    return np.where(values <= 0.0031308, 12.92 * values, power)


def decode_srgb(encoded: ArrayLike) -> NDArray[np.floating[Any]]:
    """sRGB values to linear ones (IEC 61966-2-1); 0..1 becomes 0..1.

    Any shape; float32 stays float32, everything else becomes float64.
    """
    values = _as_float(encoded)
    power = ((np.maximum(values, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(values <= 0.04045, values / 12.92, power)


def encode_srgb8(linear: ArrayLike) -> NDArray[np.uint8]:
    """Linear values to 8-bit sRGB: round(255 * encode_srgb), exactly.

    Any shape. Values outside 0..1 are clamped and NaN becomes 0.

    The upper 16 bits of a float32 name one of 128 steps per octave. The
    curve rises by less than one code in each, so that one addition of the
    lower 16 bits to a table entry carries over exactly where the code
    changes.
    """
    values = np.ascontiguousarray(linear, dtype=np.float32)
    codes = np.empty(values.shape, np.uint8)
    source, target = values.reshape(-1), codes.reshape(-1)
    table = _encoding_table()
    for start in range(0, source.size, _BLOCK):
        block = np.fmax(source[start : start + _BLOCK], np.float32(0))
        bits = np.minimum(block, np.float32(1)).view(np.uint32)
        entries = table.take(bits >> 16)
        entries += bits & 0xFFFF
        entries >>= 16
        target[start : start + _BLOCK] = entries
    return codes


def decode_srgb8(encoded: ArrayLike) -> NDArray[np.float32]:
    """8-bit sRGB (uint8, any shape) to linear float32 of the same shape."""
    return _decoding_table().take(np.asarray(encoded, dtype=np.uint8))


def luminance(rgb: ArrayLike) -> NDArray[np.floating[Any]]:
    """Luminance of linear Rec.709 colours of shape (..., 3)."""
    colours = _as_float(rgb)
    return colours @ np.asarray(LUMINANCE_WEIGHTS, colours.dtype)


def parse_hex_colour(text: str) -> tuple[float, float, float]:
    """The linear Rec.709 colour of ``#rrggbb``, which is sRGB-encoded.

    Raises OptionError for any other form.
    """
    if not re.fullmatch(r"#[0-9a-fA-F]{6}", text):
        raise OptionError(f"{text!r} is not a colour of the form #rrggbb")
    codes = np.frombuffer(bytes.fromhex(text[1:]), np.uint8)
    red, green, blue = decode_srgb(codes / 255.0).tolist()
    return red, green, blue


def _as_float(values: ArrayLike) -> NDArray[np.floating[Any]]:
    array = np.asarray(values)
    if array.dtype == np.float32:
        return array
    return array.astype(np.float64, copy=False)


@cache
def _decoding_table() -> NDArray[np.float32]:
    return decode_srgb(np.arange(256) / 255.0).astype(np.float32)


@cache
def _encoding_table() -> NDArray[np.uint32]:
    """For each upper half of the bits of 0..1: (code << 16) - step.

    ``step`` is the lower half at which the next code begins, or nothing if
    it begins in a later entry.
    """
    # The smallest float32 that rounds to each code from 1 on: the decoded
    # halfway point, rounded up to a float32.
    halfway = decode_srgb((np.arange(255) + 0.5) / 255.0)
    first = halfway.astype(np.float32)
    below = first < halfway
    first[below] = np.nextafter(first[below], np.float32(1))
    bits = first.view(np.uint32)

    entries = np.arange((0x3F800000 >> 16) + 1, dtype=np.uint32)
    codes = np.searchsorted(bits, entries << 16, side="right")
    table = (codes << 16).astype(np.uint32)
    # A code that begins inside an entry (and not at its start).
    inside = (bits & 0xFFFF) != 0
    table[bits[inside] >> 16] += 0x10000 - (bits[inside] & 0xFFFF)
    return table
