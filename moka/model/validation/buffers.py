"""Buffers and views of them: sizes, strides, what they are for."""

from typing import Any

from moka.core.errors import ModelError
from moka.model.container import read_file
from moka.model.uri import UriError, decode_data_uri, is_data_uri, resolve
from moka.model.validation.context import CheckedFile, number_of

__all__ = ["check_buffers"]

_COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_INDEX_BUFFER = 34963


def check_buffers(file: CheckedFile) -> None:
    """Read the buffers, and see that every view lies within one."""
    for number, buffer in file.all("buffers"):
        _read(file, number, buffer)
    for number, view in file.all("bufferViews"):
        _check_view(file, number, view)


def _read(file: CheckedFile, number: int, buffer: dict[str, Any]) -> None:
    place = ("buffers", number)
    size, uri = number_of(buffer.get("byteLength")), buffer.get("uri")
    data: memoryview | None = None
    if any(file.extension(buffer, name) for name in _COMPRESSED):
        return  # What stands in for compressed data need not be there.
    if uri is None:
        if number or file.binary is None:
            if file.is_container and number == 0:
                file.add(
                    "BUFFER_MISSING_GLB_DATA",
                    place,
                    "there is no binary chunk for it",
                )
            return
        data = file.binary
    elif not isinstance(uri, str):
        return
    else:
        try:
            if is_data_uri(uri):
                data = memoryview(decode_data_uri(uri))
            else:
                data = memoryview(read_file(resolve(uri, file.folder)))
        except (UriError, ModelError) as error:
            code = "INVALID_URI" if is_data_uri(uri) else "IO_ERROR"
            file.add(code, (*place, "uri"), str(error))
            return
    if size is not None and len(data) < size:
        file.add(
            "BUFFER_BYTE_LENGTH_MISMATCH",
            place,
            f"declares {size} bytes, the data has {len(data)}",
        )
        return
    file.buffers[number] = data if size is None else data[:size]


def _check_view(file: CheckedFile, number: int, view: dict[str, Any]) -> None:
    place = ("bufferViews", number)
    buffer = file.get("buffers", view.get("buffer"))
    start = number_of(view.get("byteOffset", 0))
    length = number_of(view.get("byteLength"))
    stride = number_of(view.get("byteStride"))
    if buffer is not None and start is not None and length is not None:
        size = number_of(buffer.get("byteLength"))
        if size is not None and start >= size:
            file.add(
                "BUFFER_VIEW_TOO_LONG",
                (*place, "byteOffset"),
                f"begins at byte {start} of {size}",
            )
        elif size is not None and start + length > size:
            file.add(
                "BUFFER_VIEW_TOO_LONG",
                (*place, "byteLength"),
                f"ends at byte {start + length} of {size}",
            )
    if stride is None or not 4 <= stride <= 252:
        return  # Told of its property.
    if length is not None and stride > length:
        file.add(
            "BUFFER_VIEW_TOO_BIG_BYTE_STRIDE",
            (*place, "byteStride"),
            f"is {stride}, the view has {length} bytes",
        )
    if view.get("target") == _INDEX_BUFFER:
        file.add(
            "BUFFER_VIEW_INVALID_BYTE_STRIDE",
            (*place, "byteStride"),
            "only views of vertices have one",
        )
