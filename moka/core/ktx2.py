"""KTX 2.0 files of Basis Universal textures, as KHR_texture_basisu has them.

The header is checked here before the transcoder, which is the package
``opengl_basisu``, sees a byte. It releases the interpreter's lock.

Sources: KTX 2.0 specification (Khronos), sections 3 to 5; Khronos Data
Format 1.3 for what the texels are; KHR_texture_basisu.
"""

import struct
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.errors import ImageFileError
from moka.core.extension_headers import KTX2_IDENTIFIER
from moka.core.extras import missing_decoder

__all__ = ["Ktx2Texture", "open_ktx2"]

_HEADER_SIZE = 80
_LEVEL_SIZE = 24
_MOST_PIXELS = 1 << 27
_ETC1S, _UASTC = 163, 166  # colour models of the data format descriptor
_NONE, _BASIS_LZ, _ZSTANDARD = 0, 1, 2  # supercompression


class _Header(Struct, array_like=True):
    """The numbers after the identifier, in the order of the file."""

    vk_format: int
    type_size: int
    width: int
    height: int
    depth: int
    layers: int
    faces: int
    levels: int
    supercompression: int
    descriptor_offset: int
    descriptor_length: int
    key_offset: int
    key_length: int
    global_offset: int
    global_length: int


class Ktx2Texture:
    """An opened texture of one face and one layer.

    ``size`` is (width, height) of its finest level, ``level_count`` how many
    mip levels the file has, ``is_uastc`` which of the two codecs it uses,
    ``has_alpha`` whether it stores alpha.
    """

    def __init__(self, where: str, texture: Any, *, is_uastc: bool) -> None:
        self._where = where
        self._texture = texture
        self.size: tuple[int, int] = (texture.width, texture.height)
        self.level_count: int = texture.levels
        self.is_uastc = is_uastc
        self.has_alpha: bool = texture.has_alpha

    def level(self, target: str, level: int) -> NDArray[np.uint8]:
        """One mip level in the format ``target``.

        (H, W, 4) for ``rgba8``, top row first, encoded as in the file; rows
        and columns of blocks and their bytes for ``bc1``, ``bc3``, ``bc7``,
        ``etc1``, ``etc2`` and ``astc_4x4``. Raises ImageFileError for data
        that are broken.
        """
        try:
            image = self._texture.transcode(target, level)
        except (ValueError, IndexError, MemoryError) as error:
            raise ImageFileError(
                f"{self._where}: cannot decode the KTX2 image: {error}"
            ) from error
        data: NDArray[np.uint8] = image.data
        return data


def open_ktx2(encoded: bytes | memoryview, where: str) -> Ktx2Texture:
    """Open the bytes of a KTX2 image; nothing is transcoded yet.

    Raises ImageFileError, which names ``where``, for what is broken, what
    glTF does not allow (cube maps, arrays, volumes, other codecs), or if the
    transcoder is missing.
    """
    data = bytes(encoded)
    model, fault = _check(data)
    if fault:
        raise ImageFileError(f"{where}: the KTX2 image {fault}")
    try:
        import opengl_basisu
    except ImportError as reason:
        raise ImageFileError(
            f"{where}: {missing_decoder('opengl-basisu', reason)}"
        ) from reason
    try:
        texture = opengl_basisu.Texture(data)
    except ValueError as error:
        raise ImageFileError(
            f"{where}: cannot decode the KTX2 image: {error}"
        ) from error
    return Ktx2Texture(where, texture, is_uastc=model == _UASTC)


def _check(data: bytes) -> tuple[int, str | None]:
    """The colour model, and what is wrong with the header, if anything."""
    if len(data) < _HEADER_SIZE or not data.startswith(KTX2_IDENTIFIER):
        return 0, "is cut off within its header"
    header = _Header(*struct.unpack_from("<13I2Q", data, len(KTX2_IDENTIFIER)))
    fault = _shape_fault(header) or _range_fault(header, data)
    if fault:
        return 0, fault
    model = data[header.descriptor_offset + 12]
    if model not in (_ETC1S, _UASTC):
        return model, f"has colour model {model}, glTF allows ETC1S and UASTC"
    expected = (_BASIS_LZ,) if model == _ETC1S else (_NONE, _ZSTANDARD)
    if header.supercompression not in expected:
        return model, (
            f"has supercompression {header.supercompression}, which its "
            "codec does not allow"
        )
    return model, _level_fault(header, data, model) or _orientation_fault(
        header, data
    )


def _shape_fault(header: _Header) -> str | None:
    if header.vk_format:
        return (
            f"has texels of vkFormat {header.vk_format} and not of Basis "
            "Universal, which is all that glTF allows"
        )
    if header.faces != 1:
        return f"is a cube map of {header.faces} faces, not one picture"
    if header.layers:
        return f"is an array of {header.layers} layers, not one picture"
    if header.depth:
        return f"is a volume {header.depth} deep, not one picture"
    width, height = header.width, header.height
    if not width or not height:
        return f"has {width} x {height} pixels"
    if width * height > _MOST_PIXELS:
        return f"has {width} x {height} pixels, which are too many"
    if header.levels > max(width, height).bit_length():
        return f"has {header.levels} levels for {width} x {height} pixels"
    return None


def _range_fault(header: _Header, data: bytes) -> str | None:
    """Whether all parts but the levels lie inside the file."""
    for name, start, length, least in (
        ("levels", _HEADER_SIZE, _LEVEL_SIZE * max(header.levels, 1), 0),
        ("format", header.descriptor_offset, header.descriptor_length, 28),
        ("keys", header.key_offset, header.key_length, 0),
        ("tables", header.global_offset, header.global_length, 0),
    ):
        if length < least or (length and start + length > len(data)):
            return f"is cut off: its {name} lie beyond {len(data)} bytes"
    return None


def _level_fault(header: _Header, data: bytes, model: int) -> str | None:
    for level in range(max(header.levels, 1)):
        offset, length, plain = struct.unpack_from(
            "<3Q", data, _HEADER_SIZE + level * _LEVEL_SIZE
        )
        if not length or offset + length > len(data):
            return f"is cut off: level {level} ends beyond {len(data)} bytes"
        width = max(1, header.width >> level)
        height = max(1, header.height >> level)
        needed = -(-width // 4) * -(-height // 4) * 16
        if header.supercompression == _NONE:
            plain = length
        if model == _UASTC and plain != needed:
            return f"has {plain} bytes in level {level}, which takes {needed}"
    return None


def _orientation_fault(header: _Header, data: bytes) -> str | None:
    """glTF allows images whose rows run down, and no others."""
    keys = data[header.key_offset : header.key_offset + header.key_length]
    _, found, value = keys.partition(b"KTXorientation\0")
    if found and value[:2] != b"rd":
        name = value[:2].decode("ascii", "replace")
        return f"has the orientation {name!r}, glTF allows 'rd'"
    return None
