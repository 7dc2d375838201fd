"""Radiance pictures (.hdr, .pic): a header of text, then RGBE pixels.

Ward, Radiance File Formats, chapter "Picture File Format". moka reads both
run-length codes and flat pixels, all eight orientations, RGBE and XYZE.
"""

import math
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.atomic_file import image_file
from moka.core.colour import XYZ_TO_REC709
from moka.core.errors import EnvironmentMapError
from moka.core.radiance_scanlines import decode_scanlines, encode_scanlines
from moka.core.rgbe import decode_rgbe, encode_rgbe

__all__ = ["parse_radiance_hdr", "read_radiance_hdr", "write_radiance_hdr"]

#: Headers are a few lines; one without an end is not searched for longer.
_LONGEST_HEADER = 1 << 16

#: More pixels than this are a broken header rather than a picture.
_MOST_PIXELS = 1 << 28

_RESOLUTION = re.compile(rb"([+-])([XY]) +(\d{1,9}) +([+-])([XY]) +(\d{1,9})")


class _Header(Struct, frozen=True):
    """What stands before the pixels, which begin at ``end``.

    ``exposure`` is what radiance was multiplied by, per channel. Scanlines
    run along ``axes[1]``, and follow one another along ``axes[0]``.
    """

    is_xyz: bool
    exposure: tuple[float, float, float]
    axes: tuple[bytes, bytes]
    sizes: tuple[int, int]
    end: int


def read_radiance_hdr(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """The radiance of a .hdr file: float32 (H, W, 3), top row first.

    Raises EnvironmentMapError when it cannot be read or is broken.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise EnvironmentMapError(
            f"{os.fspath(path)}: cannot read the file: {error.strerror}"
        ) from error
    return parse_radiance_hdr(data, os.fspath(path))


def parse_radiance_hdr(data: bytes, where: str) -> NDArray[np.float32]:
    """Radiance from the contents of a file: float32 (H, W, 3), top first.

    Linear Rec.709: the primaries are taken for these, XYZ is converted.
    Values are divided by the exposures of the header, as the format
    defines. ``where`` names the file in the EnvironmentMapError that is
    raised for anything cut off or broken.
    """
    try:
        header = _parse_header(data)
        height, width = header.sizes
        rgbe = decode_scanlines(data[header.end :], width, height)
    except ValueError as error:
        raise EnvironmentMapError(
            f"{where}: not a readable Radiance HDR file: {error}"
        ) from error
    pixels = decode_rgbe(rgbe)
    if header.exposure != (1.0, 1.0, 1.0):
        pixels /= np.array(header.exposure, np.float32)
    if header.is_xyz:
        pixels = pixels @ XYZ_TO_REC709.T.astype(np.float32)
    return _turn_upright(pixels, header.axes)


def write_radiance_hdr(
    path: str | os.PathLike[str],
    pixels: NDArray[np.floating[Any]],
    *,
    coding: str = "new",
) -> None:
    """Write linear ``pixels`` (H, W, 3), top row first, as RGBE.

    ``coding`` is ``new`` or ``old`` for one of the two run-length codes, or
    ``flat``. A file at ``path`` is replaced at once or not at all. Raises
    ImageFileError when it cannot be written.
    """
    if coding not in ("new", "old", "flat"):
        raise ValueError(f"unknown coding {coding!r}")
    height, width, _ = pixels.shape
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    body = encode_scanlines(encode_rgbe(pixels), coding)
    with image_file(path) as temporary:
        temporary.write_bytes(header.encode() + body)


def _parse_header(data: bytes) -> _Header:
    if not data.startswith(b"#?"):
        raise ValueError("it does not begin with #?")
    is_xyz = False
    exposure = np.ones(3)
    lines = _lines(data)
    for line, _ in lines:
        if not line:
            break
        key, equals, value = line.partition(b"=")
        if not equals or line.startswith(b"#"):
            continue
        if key == b"FORMAT":
            if value.strip() not in (b"32-bit_rle_rgbe", b"32-bit_rle_xyze"):
                raise ValueError(f"its format is {_shown(value)}")
            is_xyz = value.strip().endswith(b"xyze")
        elif key == b"EXPOSURE":
            exposure *= _numbers(line, value, 1)
        elif key == b"COLORCORR":
            exposure *= _numbers(line, value, 3)

    line, end = next(lines)
    match = _RESOLUTION.fullmatch(line.strip())
    if not match or match[2] == match[5]:
        raise ValueError(f"its resolution is {_shown(line)}")
    sizes = int(match[3]), int(match[6])
    if not 0 < sizes[0] * sizes[1] <= _MOST_PIXELS:
        raise ValueError(f"its resolution is {_shown(line)}")
    red, green, blue = exposure.tolist()
    return _Header(
        is_xyz,
        (red, green, blue),
        (match[1] + match[2], match[4] + match[5]),
        sizes,
        end,
    )


def _lines(data: bytes) -> Iterator[tuple[bytes, int]]:
    """The lines of a header, and where the next one begins."""
    position = 0
    while position < _LONGEST_HEADER:
        end = data.find(b"\n", position, _LONGEST_HEADER)
        if end < 0:
            break
        yield data[position:end].removesuffix(b"\r"), end + 1
        position = end + 1
    raise ValueError("its header does not end")


def _numbers(line: bytes, value: bytes, count: int) -> NDArray[np.float64]:
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(
        0.0 < number < math.inf for number in numbers
    ):
        raise ValueError(f"its header says {_shown(line)}")
    return np.array(numbers)


def _shown(text: bytes) -> str:
    return repr(text[:60].decode("latin-1"))


def _turn_upright(
    pixels: NDArray[np.float32], axes: tuple[bytes, bytes]
) -> NDArray[np.float32]:
    """Rows from top to bottom, columns from left to right."""
    if axes[0].endswith(b"X"):
        pixels = pixels.swapaxes(0, 1)
    if b"+Y" in axes:
        pixels = pixels[::-1]
    if b"-X" in axes:
        pixels = pixels[:, ::-1]
    return np.ascontiguousarray(pixels)
