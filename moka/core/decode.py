"""Decodes images to arrays of texels, in any thread.

glTF 2.0 allows PNG and JPEG (3.8.3), extensions bring WebP, AVIF and KTX2.
It says that embedded colour profiles are ignored, and leaves the rest to what
image libraries agree on. They release the interpreter's lock while they
decode.
"""

import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.image_header import media_type

if TYPE_CHECKING:
    from PIL.ImageFile import ImageFile

__all__ = ["decode_image"]

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"

#: More pixels than 16384 x 8192 are taken for a decompression bomb.
_MOST_PIXELS = 1 << 27

_ORIENTATION_TAG = 0x0112

#: How Pillow reads colours of 16 bits, and how it reads their lower half.
_DEEP_MODES = {"RGB;16B": "RGB;16L", "RGBA;16B": "RGBA;16L"}

#: Pillow's modes that are texels as they are.
_PLAIN_MODES = frozenset({"L", "LA", "RGB", "RGBA"})


def decode_image(image: EncodedImage) -> NDArray[Any]:
    """The texels of ``image``: (H, W, C) of uint8 or uint16, top row first.

    C is 1 to 4: grey, grey and alpha, RGB, RGBA. Palettes become RGB, or
    RGBA where they or a colour key (tRNS) make something transparent; CMYK
    becomes RGB. 16 bits are kept for grey, RGB and RGBA; grey and alpha of
    16 bits become RGBA of 8. An EXIF orientation is applied, as browsers
    do. The values stay encoded as they are in the file. Raises
    ImageFileError, which names ``image.where``, for anything broken,
    truncated or larger than 2^27 pixels.
    """
    data = image.read()
    if media_type(data) == "image/ktx2":
        from moka.core.ktx2 import open_ktx2

        return open_ktx2(data, image.where).level("rgba8", 0)
    try:
        with _open(data) as file:
            width, height = file.size
            if width * height > _MOST_PIXELS:
                raise ValueError(f"{width} x {height} pixels are too many")
            deep = any(tile.args in _DEEP_MODES for tile in file.tile)
            texels = _deep_texels(file, data) if deep else _texels(file)
            exif = file.info.get("exif", b"")
    # On hostile bytes a decoder may raise nearly anything.
    except Exception as error:
        raise ImageFileError(
            f"{image.where}: cannot decode the image: {error}"
        ) from error
    if texels.ndim == 2:
        texels = texels[:, :, np.newaxis]
    return _orient(texels, _orientation(exif))


def _open(data: bytes | memoryview) -> "ImageFile":
    # Pillow's own open() would import every common format first, and warn
    # about sizes below our limit.
    start = bytes(data[: len(_PNG)])
    if start == _PNG:
        from PIL.PngImagePlugin import PngImageFile

        return PngImageFile(io.BytesIO(data))
    if start.startswith(_JPEG):
        from PIL.JpegImagePlugin import JpegImageFile

        return JpegImageFile(io.BytesIO(data))
    kind = media_type(data)
    if kind == "image/webp":
        from PIL.WebPImagePlugin import WebPImageFile

        return WebPImageFile(io.BytesIO(data))
    if kind == "image/avif":
        from PIL.AvifImagePlugin import AvifImageFile

        return AvifImageFile(io.BytesIO(data))
    raise ValueError("it is neither PNG, JPEG, WebP nor AVIF")


def _texels(file: "ImageFile") -> NDArray[Any]:
    if file.mode.startswith("I"):  # grey of 16 bits
        return np.asarray(file).astype(np.uint16, copy=False)
    if "transparency" in file.info:
        mode = "LA" if file.mode in ("1", "L") else "RGBA"
    elif file.mode in _PLAIN_MODES:
        return np.asarray(file)
    else:
        mode = "L" if file.mode == "1" else "RGB"
    return np.asarray(file.convert(mode))


def _deep_texels(file: "ImageFile", data: bytes | memoryview) -> NDArray[Any]:
    """RGB or RGBA of 16 bits, of which Pillow keeps the upper eight.

    The lower eight are the upper ones of the same bytes, read as if the
    file were little-endian.
    """
    with _open(data) as again:
        again.tile = [
            tile._replace(args=_DEEP_MODES[str(tile.args)])
            for tile in again.tile
        ]
        lower = np.asarray(again)
    texels: NDArray[np.uint16] = np.asarray(file).astype(np.uint16)
    texels <<= 8
    texels |= lower
    return texels


def _orientation(exif: bytes) -> int:
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


def _orient(texels: NDArray[Any], orientation: int) -> NDArray[Any]:
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
