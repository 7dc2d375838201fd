"""The bytes of a glTF file: JSON text alone, or a binary .glb container.

Source: glTF 2.0 specification, section 4 (GLB file format).
"""

import os
import stat
import struct
from pathlib import Path

from moka.core.errors import ModelError

__all__ = ["read_file", "split_container"]

_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BINARY_CHUNK = 0x004E4942
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def read_file(path: Path, size: int | None = None) -> bytes:
    """The first ``size`` bytes of a file, all of them by default.

    Raises ModelError if it cannot be read, is not a regular file (a device
    may have no end) or holds less than ``size`` bytes, before any memory is
    allocated for it.
    """
    try:
        with open(path, "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise ModelError(f"{path}: not a regular file")
            if size is not None and status.st_size < size:
                raise ModelError(
                    f"{path}: holds {status.st_size} bytes, {size} are needed"
                )
            return file.read(-1 if size is None else size)
    except FileNotFoundError as error:
        raise ModelError(f"{path}: no such file") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError(f"{path}: cannot be read: {reason}") from error


def split_container(
    data: memoryview, where: str
) -> tuple[memoryview, memoryview | None]:
    """The JSON text and the binary chunk of a .gltf or a .glb.

    Nothing is copied. Raises ModelError naming ``where`` if the data is
    neither, or cut off.
    """
    if data[:4] == _MAGIC:
        return _split_binary(data, where)
    start = len(_BYTE_ORDER_MARK) if data[:3] == _BYTE_ORDER_MARK else 0
    text = data[start:]
    if not bytes(text[:64]).lstrip().startswith(b"{"):
        raise ModelError(
            f"{where}: neither a .glb (which begins with 'glTF') nor a .gltf "
            "(which begins with '{')"
        )
    return text, None


def _split_binary(
    data: memoryview, where: str
) -> tuple[memoryview, memoryview | None]:
    if len(data) < 12:
        raise ModelError(f"{where}: cut off within the header of the .glb")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise ModelError(
            f"{where}: the .glb has version {version}, only 2 is supported"
        )
    if length > len(data):
        raise ModelError(
            f"{where}: cut off after {len(data)} of {length} bytes"
        )
    chunks: list[tuple[int, memoryview]] = []
    offset = 12
    while offset + 8 <= length:
        size, kind = struct.unpack_from("<II", data, offset)
        offset += 8
        if offset + size > length:
            raise ModelError(
                f"{where}: chunk {len(chunks)} of the .glb needs {size} "
                f"bytes, {length - offset} are left"
            )
        chunks.append((kind, data[offset : offset + size]))
        offset += size
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise ModelError(f"{where}: the first chunk of the .glb is not JSON")
    # Some exporters pad the text with zeros where the format wants spaces.
    text = chunks[0][1]
    end = len(bytes(text[-4:]).rstrip(b"\0")) + max(0, len(text) - 4)
    # Chunks of other kinds must be skipped (section 4.4).
    if len(chunks) > 1 and chunks[1][0] == _BINARY_CHUNK:
        return text[:end], chunks[1][1]
    return text[:end], None
