"""Primitives that Draco compressed, decoded by its own code.

Source: KHR_draco_mesh_compression; the header is that of Draco's bitstream,
version 2.2.
"""

from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.extras import missing_decoder
from moka.model.accessors import COMPONENTS, AccessorReader
from moka.model.schema import Accessor, Index, Primitive, read_extension
from moka.model.source import GltfSource
from moka.model.workers import map_in_workers

__all__ = ["DecodedPrimitive", "decode_primitives"]

_NAME = "KHR_draco_mesh_compression"
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES = (4, 5)  # the modes that it may compress

# The start of a bitstream: "DRACO", two digits of version, whether it is a
# mesh, its method, flags.
_MAGIC = b"DRACO"
_HEADER_SIZE = 11
_MESH, _SEQUENTIAL, _METADATA = 1, 0, 0x80
# An encoder may split vertices; beyond this a count is no honest one.
_MOST_SPLITS = 8


class DecodedPrimitive(Struct):
    """What a primitive is read from instead of the file's own buffers.

    ``accessors`` know the decoded elements; ``indices``, uint32 (M,), form
    a list of triangles.
    """

    accessors: AccessorReader
    indices: NDArray[np.uint32]


class _Compressed(Struct, rename="camel", gc=False):
    """The object that a primitive carries."""

    buffer_view: Index
    attributes: dict[str, Index]


class _Part(Struct):
    """One primitive to be decoded."""

    path: str
    primitive: Primitive
    compressed: _Compressed


class _DecodedAccessors(AccessorReader):
    """Knows some elements, and reads all others as ``base`` does."""

    def __init__(
        self,
        source: GltfSource,
        base: AccessorReader,
        arrays: dict[int, NDArray[Any]],
    ) -> None:
        super().__init__(source)
        self._base = base
        self._arrays = arrays

    def array(self, index: int) -> NDArray[Any]:
        """See :meth:`AccessorReader.array`."""
        known = index in self._arrays
        return self._arrays[index] if known else self._base.array(index)

    def floats(self, index: int) -> NDArray[np.float32]:
        """See :meth:`AccessorReader.floats`."""
        known = index in self._arrays
        return super().floats(index) if known else self._base.floats(index)


def decode_primitives(
    source: GltfSource, accessors: AccessorReader
) -> dict[str, DecodedPrimitive]:
    """The compressed primitives by their JSON paths, several at once.

    Those that the file has uncompressed too are left out if the package is
    missing. Raises ModelError for anything that is not as the extension
    says.
    """
    parts = _parts(source)
    if not parts:
        return {}
    try:
        import DracoPy
    except ImportError as reason:
        for part in parts:
            if not _has_plain_elements(source, part.primitive):
                raise source.error(
                    f"{part.path}.extensions.{_NAME}",
                    missing_decoder("DracoPy", reason),
                ) from reason
        return {}
    decoded = map_in_workers(lambda part: _decode(source, DracoPy, part), parts)
    return {
        part.path: DecodedPrimitive(
            _DecodedAccessors(source, accessors, arrays), indices
        )
        for part, (arrays, indices) in zip(parts, decoded, strict=True)
    }


def _parts(source: GltfSource) -> list[_Part]:
    parts = []
    for index, mesh in enumerate(source.document.meshes):
        for number, primitive in enumerate(mesh.primitives):
            path = f"meshes[{index}].primitives[{number}]"
            compressed = read_extension(
                primitive, _NAME, _Compressed, source.where, path
            )
            if compressed is not None and "POSITION" in primitive.attributes:
                parts.append(_Part(path, primitive, compressed))
    return parts


def _has_plain_elements(source: GltfSource, primitive: Primitive) -> bool:
    """Whether a file without its Draco data would be whole."""
    accessors = source.document.accessors
    used = [*primitive.attributes.values()]
    if primitive.indices is not None:
        used.append(primitive.indices)
    return _NAME not in source.document.extensions_required and all(
        index < len(accessors) and accessors[index].buffer_view is not None
        for index in used
    )


def _decode(
    source: GltfSource, draco: Any, part: _Part
) -> tuple[dict[int, NDArray[Any]], NDArray[np.uint32]]:
    """Elements by accessor, and indices."""
    document = source.document
    path = f"{part.path}.extensions.{_NAME}"
    if part.primitive.mode not in _TRIANGLES:
        raise source.error(
            f"{part.path}.mode",
            f"is {part.primitive.mode}; {_NAME} compresses triangles only",
        )
    view = part.compressed.buffer_view
    source.check_index(
        f"{path}.bufferView", view, "bufferViews", len(document.buffer_views)
    )
    accessors: dict[str, int] = {}
    for name in part.compressed.attributes:
        if name not in part.primitive.attributes:
            raise source.error(
                f"{path}.attributes.{name}", "is none of the primitive's own"
            )
        accessors[name] = index = part.primitive.attributes[name]
        source.check_index(
            f"{part.path}.attributes.{name}",
            index,
            "accessors",
            len(document.accessors),
        )
    data = bytes(source.view(view))
    fault = _fault(data, _most(source, part, accessors))
    if fault:
        raise source.error(path, fault)
    try:
        mesh = draco.decode(data)
    # It has errors of its own for some faults, and of Python's for others;
    # whatever is wrong, they say that it is no Draco data.
    except Exception as reason:
        raise source.error(
            path, "the Draco data cannot be decoded: they are damaged"
        ) from reason
    found = {each["unique_id"]: each for each in mesh.attributes}
    arrays = {}
    for name, number in part.compressed.attributes.items():
        accessor = document.accessors[accessors[name]]
        place = f"{path}.attributes.{name}"
        if number not in found:
            raise source.error(place, f"the Draco data have no id {number}")
        try:
            arrays[accessors[name]] = _elements(found[number], accessor)
        except ValueError as reason:
            raise source.error(place, str(reason)) from reason
    faces = np.asarray(getattr(mesh, "faces", ()), np.uint32)
    return arrays, faces.reshape(-1)


def _most(source: GltfSource, part: _Part, accessors: dict[str, int]) -> int:
    """The most points or triangles that the accessors account for."""
    used = [*accessors.values()]
    if part.primitive.indices is not None:
        used.append(part.primitive.indices)
    counts = [
        source.document.accessors[index].count
        for index in used
        if index < len(source.document.accessors)
    ]
    return _MOST_SPLITS * max(counts, default=0)


def _fault(data: bytes, most: int) -> str | None:
    """What is wrong with the header, found before anything is allocated."""
    if len(data) < _HEADER_SIZE or not data.startswith(_MAGIC):
        return "the buffer view holds no Draco data"
    if data[7] != _MESH:
        return "the Draco data are a point cloud, not triangles"
    if (data[5], data[6]) != (2, 2) or data[10] & _METADATA:
        return None  # where the counts stand depends on more
    start = _HEADER_SIZE + (data[8] != _SEQUENTIAL)
    for _ in range(2):  # triangles and vertices, in either order
        count, start = _varint(data, start)
        if count > most:
            return (
                f"the Draco data ask for {count} vertices or triangles, far "
                "more than the accessors have"
            )
    return None


def _varint(data: bytes, start: int) -> tuple[int, int]:
    """An integer of seven bits a byte, and where the next one starts."""
    value, shift = 0, 0
    while start < len(data):
        value |= (data[start] & 0x7F) << shift
        shift += 7
        start += 1
        if data[start - 1] < 0x80:
            break
    return value, start


def _elements(attribute: dict[str, Any], accessor: Accessor) -> NDArray[Any]:
    """Decoded elements in the accessor's own type.

    Raises ValueError if they do not fit it.
    """
    width = _WIDTHS.get(accessor.type)
    data: NDArray[Any] = attribute["data"]
    if attribute["num_components"] != width or data.ndim != 2:
        raise ValueError(
            f"has {attribute['num_components']} components, the accessor is "
            f"{accessor.type}"
        )
    if not len(data):
        raise ValueError("is empty")
    dtype = COMPONENTS[accessor.component_type]
    if dtype.kind != "f":
        limits = np.iinfo(dtype)
        if accessor.normalized and data.dtype.kind == "f":
            # Signed integers come as floats, divided by their range if
            # Draco knows that they are to be: then all are within 1.
            if np.abs(data).max(initial=0) <= 1:
                data = data * np.float32(limits.max)
            data = np.rint(data)
        if not (limits.min <= data.min() and data.max() <= limits.max):
            raise ValueError(f"has values beyond the accessor's {dtype.name}")
    elements = np.ascontiguousarray(data.astype(dtype))
    if width == 1:
        elements = elements[:, 0]
    elements.flags.writeable = False
    return elements
