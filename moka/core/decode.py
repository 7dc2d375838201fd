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
from moka.core.exif import exif_of_jpeg, orientation_of, turn_upright
from moka.core.image_header import media_type
from moka.core.jpeg import decode_common_jpeg
from moka.core.pillow_texels import pillow_texels

if TYPE_CHECKING:
    from PIL.ImageFile import ImageFile

__all__ = ["decode_image", "with_alpha"]

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"

#: More pixels than 16384 x 8192 are taken for a decompression bomb.
_MOST_PIXELS = 1 << 27

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
    do. The values stay encoded as they are in the file. RGB of 8 bits may be
    a view of four channels, whose last is 255; see :func:`with_alpha`.
    Raises ImageFileError, which names ``image.where``, for anything broken,
    truncated or larger than 2^27 pixels.
    """
    data = image.read()
    if media_type(data) == "image/ktx2":
        from moka.core.ktx2 import open_ktx2

        return open_ktx2(data, image.where).level("rgba8", 0)
    if bytes(data[: len(_JPEG)]) == _JPEG:
        common = decode_common_jpeg(data, _MOST_PIXELS)
        if common is not None:
            return turn_upright(common, orientation_of(exif_of_jpeg(data)))
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
    return turn_upright(texels, orientation_of(exif))


def with_alpha(texels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """RGB (H, W, 3) with an alpha of 255: (H, W, 4).

    Nothing is copied of what :func:`decode_image` returned as a view.
    """
    height, width, _ = texels.shape
    given = texels.base
    if (
        isinstance(given, np.ndarray)
        and given.shape == (height, width, 4)
        and given.strides == (4 * width, 4, 1) == texels.strides
        and given.ctypes.data == texels.ctypes.data
    ):
        return given
    padded = np.full((height, width, 4), 255, np.uint8)
    for channel in range(3):
        # Four times as fast as all three at once.
        padded[:, :, channel] = texels[:, :, channel]
    return padded


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
        return pillow_texels(file)
    else:
        mode = "L" if file.mode == "1" else "RGB"
    return pillow_texels(file.convert(mode))


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
