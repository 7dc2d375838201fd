"""Which way up a picture is: its EXIF orientation, and turning it so."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["exif_of_jpeg", "orientation_of", "turn_upright"]

_ORIENTATION_TAG = 0x0112
_APP1 = 0xE1
_START_OF_SCAN = 0xDA


def exif_of_jpeg(data: bytes | memoryview) -> bytes:
    """The EXIF data of a JPEG file, empty if there are none.

    ITU-T T.81, B.1.1.4: segments with their length, up to the first scan.
    """
    start = 2
    while start + 4 <= len(data) and data[start] == 0xFF:
        marker = data[start + 1]
        if marker == 0xFF:  # markers may be padded with FF
            start += 1
            continue
        if marker == _START_OF_SCAN:
            break
        size = max(2, int.from_bytes(data[start + 2 : start + 4], "big"))
        content = bytes(data[start + 4 : start + 2 + size])
        if marker == _APP1 and content.startswith(b"Exif\0\0"):
            return content
        start += 2 + size
    return b""


def orientation_of(exif: bytes) -> int:
    """The orientation 1 to 8 of EXIF data, 1 where it says nothing.

    EXIF 2.32, 4.6.4 A: a TIFF header and a directory of entries of 12 bytes.
    """
    tiff = exif.removeprefix(b"Exif\0\0")
    order = {b"II": "little", b"MM": "big"}.get(tiff[:2])
    if order is None:
        return 1

    def number(start: int, size: int) -> int:
        digits = tiff[start : start + size]
        return int.from_bytes(digits, "little" if order == "little" else "big")

    entries = number(4, 4) + 2
    for index in range(number(entries - 2, 2)):
        entry = entries + 12 * index
        if number(entry, 2) == _ORIENTATION_TAG:
            value = number(entry + 8, 2)
            return value if 1 <= value <= 8 else 1
    return 1


def turn_upright(texels: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Texels turned and mirrored so that orientation 1 is reached."""
    if orientation == 1:
        return texels
    if orientation >= 5:
        texels = texels.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        texels = texels[::-1]
    if orientation in (2, 3, 6, 7):
        texels = texels[:, ::-1]
    return np.ascontiguousarray(texels)
