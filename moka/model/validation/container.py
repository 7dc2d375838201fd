"""The chunks of a .glb.

Source: glTF 2.0 specification, section 4 (GLB file format).
"""

import struct

from moka.model.validation.issues import Report

__all__ = ["split_checked"]

_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_WHOLE = ()  # The file itself has no JSON path.


def split_checked(
    data: memoryview, report: Report
) -> tuple[memoryview | None, memoryview | None]:
    """The JSON text and the binary chunk, as far as they can be had."""
    if len(data) < 12:
        report.add(
            "GLB_UNEXPECTED_END_OF_HEADER", _WHOLE, "ends within the header"
        )
        return None, None
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        report.add(
            "GLB_INVALID_VERSION",
            _WHOLE,
            f"the container has version {version}",
        )
        return None, None
    if length > len(data):
        report.add(
            "GLB_LENGTH_MISMATCH",
            _WHOLE,
            f"the header says {length} bytes, the file has {len(data)}",
        )
    return _split_chunks(data, length, report)


def _split_chunks(
    data: memoryview, length: int, report: Report
) -> tuple[memoryview | None, memoryview | None]:
    chunks: dict[int, memoryview] = {}
    offset = 12
    while offset < len(data) and offset != length:
        if len(data) - offset < 8:
            report.add(
                "GLB_UNEXPECTED_END_OF_CHUNK_HEADER",
                _WHOLE,
                "ends within the header of a chunk",
            )
            return chunks.get(_JSON), chunks.get(_BINARY)
        size, kind = struct.unpack_from("<II", data, offset)
        offset += 8
        _check_chunk(size, kind, offset, length, chunks, report)
        if kind in (_JSON, _BINARY):
            chunks.setdefault(kind, data[offset : offset + size])
        offset += size
    if offset == length and length < len(data):
        report.add(
            "GLB_EXTRA_DATA",
            _WHOLE,
            f"{len(data) - length} bytes follow the end of the container",
        )
    elif offset != length and offset <= len(data):
        report.add(
            "GLB_LENGTH_MISMATCH",
            _WHOLE,
            f"the header says {length} bytes, the chunks end at {offset}",
        )
    return chunks.get(_JSON), chunks.get(_BINARY)


def _check_chunk(
    size: int,
    kind: int,
    offset: int,
    length: int,
    before: dict[int, memoryview],
    report: Report,
) -> None:
    """A chunk of ``size`` bytes at ``offset``, after those ``before``."""
    name = f"chunk {kind:#010x}"
    if size % 4:
        report.add(
            "GLB_CHUNK_LENGTH_UNALIGNED",
            _WHOLE,
            f"{name} has {size} bytes, no multiple of 4",
        )
    if offset + size > length:
        report.add(
            "GLB_CHUNK_TOO_BIG",
            _WHOLE,
            f"{name} of {size} bytes goes beyond the container's {length}",
        )
    if not before and kind != _JSON:
        report.add("GLB_UNEXPECTED_FIRST_CHUNK", _WHOLE, f"{name} is not JSON")
    if kind in before:
        report.add("GLB_DUPLICATE_CHUNK", _WHOLE, f"{name} is there twice")
    elif kind not in (_JSON, _BINARY):
        report.add("GLB_UNKNOWN_CHUNK_TYPE", _WHOLE, f"{name} is unknown")
