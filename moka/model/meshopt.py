"""Buffer views that meshoptimizer compressed, decoded by its own code.

Sources: EXT_meshopt_compression, and KHR_meshopt_compression, which adds the
filter for colours and version 1 of the codec for attributes.
"""

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from msgspec import Meta, Struct

from moka.core.extras import missing_decoder
from moka.model.schema import BufferView, Index, Size, read_extension
from moka.model.workers import map_in_workers

if TYPE_CHECKING:
    from moka.model.source import GltfSource

__all__ = ["decode_ahead", "decode_view", "is_compressed"]

_NAMES = ("KHR_meshopt_compression", "EXT_meshopt_compression")

# The attribute codec works on blocks of at most so many bytes and elements.
_BLOCK_BYTES = 8192
_BLOCK_ELEMENTS = 256

# The strides that the extensions allow to each filter.
_FILTER_STRIDES = {"OCTAHEDRAL": (4, 8), "COLOR": (4, 8), "QUATERNION": (8,)}


class _Compressed(Struct, rename="camel", gc=False):
    """The object that a buffer view carries."""

    buffer: Index
    byte_length: Size
    byte_stride: Annotated[int, Meta(ge=1, le=256)]
    count: Annotated[int, Meta(ge=1, le=2**32 - 1)]
    mode: Literal["ATTRIBUTES", "TRIANGLES", "INDICES"]
    byte_offset: Size = 0
    filter: Literal[
        "NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"
    ] = "NONE"


class _Fallback(Struct, gc=False):
    """The object that the buffer of a view may carry."""

    fallback: bool = False


def is_compressed(view: BufferView) -> bool:
    """Whether ``view`` has one of the extensions."""
    return view.extensions is not None and any(
        name in view.extensions for name in _NAMES
    )


def decode_ahead(source: "GltfSource") -> None:
    """Decode the views of vertices and indices, several at once."""
    document = source.document
    used = {
        accessor
        for mesh in document.meshes
        for primitive in mesh.primitives
        for accessor in (
            *primitive.attributes.values(),
            primitive.indices,
            *(each for one in primitive.targets for each in one.values()),
        )
    }
    views = {
        accessor.buffer_view
        for index, accessor in enumerate(document.accessors)
        if index in used
    }
    map_in_workers(
        source.view,
        [
            index
            for index, view in enumerate(document.buffer_views)
            if index in views and is_compressed(view)
        ],
    )


def decode_view(source: "GltfSource", index: int) -> memoryview | None:
    """The decoded bytes of a buffer view that is compressed.

    None if they are to be read from the view's own buffer: the package is
    missing, and the file has the bytes uncompressed too. Raises ModelError
    for anything that is not as the extension says. Needs no lock of the
    interpreter while it decodes.
    """
    view = source.document.buffer_views[index]
    name = next(name for name in _NAMES if name in (view.extensions or ()))
    compressed = read_extension(
        view, name, _Compressed, source.where, f"bufferViews[{index}]"
    )
    assert compressed is not None
    path = f"bufferViews[{index}].extensions.{name}"
    try:
        import meshopt
    except ImportError as reason:
        if _has_plain_bytes(source, view, name):
            return None
        raise source.error(path, missing_decoder("meshopt", reason)) from reason
    fault = _fault(compressed, view.byte_length)
    if fault:
        raise source.error(path, fault)
    data = source.range(
        path,
        compressed.buffer,
        compressed.byte_offset,
        compressed.byte_length,
    )
    try:
        decoded = meshopt.decode_gltf_buffer(
            data,
            compressed.count,
            compressed.byte_stride,
            compressed.mode,
            compressed.filter,
        )
    except (ValueError, MemoryError) as reason:
        raise source.error(
            path, f"cannot be decoded: {str(reason) or 'too large'}"
        ) from reason
    octets: memoryview = decoded.reshape(-1).view(np.uint8).data
    return octets


def _fault(compressed: _Compressed, view_length: int) -> str | None:
    """What contradicts the extension, found before anything is allocated."""
    count, stride = compressed.count, compressed.byte_stride
    mode, filter_ = compressed.mode, compressed.filter
    if mode == "ATTRIBUTES":
        if stride % 4:
            return f"byteStride: {stride} is no multiple of 4"
        block = min(_BLOCK_ELEMENTS, _BLOCK_BYTES // stride & ~15)
        # In the best case every four bytes of a block's elements take one.
        least = 1 + -(-count // block) * (stride // 4)
    else:
        if stride not in (2, 4):
            return f"byteStride: indices have 2 or 4 bytes, not {stride}"
        if filter_ != "NONE":
            return f"filter: is {filter_}, indices have none"
        if mode == "TRIANGLES" and count % 3:
            return f"count: {count} is no multiple of 3"
        least = 1 + (count // 3 if mode == "TRIANGLES" else count)
    if stride not in _FILTER_STRIDES.get(filter_, (stride,)):
        return f"byteStride: {stride} does not fit the filter {filter_}"
    if count * stride != view_length:
        return (
            f"count: {count} elements of {stride} bytes do not fill the "
            f"{view_length} bytes of the buffer view"
        )
    if compressed.byte_length < least:
        return (
            f"byteLength: {compressed.byte_length} bytes cannot hold {count} "
            "elements"
        )
    return None


def _has_plain_bytes(source: "GltfSource", view: BufferView, name: str) -> bool:
    buffers = source.document.buffers
    if name in source.document.extensions_required:
        return False
    if view.buffer >= len(buffers):
        return False
    fallback = read_extension(
        buffers[view.buffer],
        name,
        _Fallback,
        source.where,
        f"buffers[{view.buffer}]",
    )
    return fallback is None or not fallback.fallback
