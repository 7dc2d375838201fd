"""Puts primitives into shared vertex and index buffers.

All primitives of a model that have one vertex layout share one pair of
buffers and differ by base vertex and first index, so that one GL call can
draw many of them. Only attributes that the material's shader reads are
uploaded.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import (
    BufferDescriptor,
    BufferUsage,
    IndexType,
    MeshDescriptor,
    VertexAttribute,
    VertexLayout,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.model.mesh import INFLUENCES, Primitive
from moka.renderer.vertices import (
    LINE_OTHER,
    MADE_TANGENTS,
    Vertices,
    vertices_of,
)

__all__ = ["GeometryPool", "JoinedMeshes", "Upload", "vertex_layout"]

# glTF attribute: shader input, components. All are float32 on the GPU.
_ATTRIBUTES = {
    "POSITION": ("position", 3),
    "NORMAL": ("normal", 3),
    "TANGENT": ("tangent", 4),
    **dict.fromkeys(MADE_TANGENTS, ("tangent", 4)),
    "TEXCOORD_0": ("uv_0", 2),
    "TEXCOORD_1": ("uv_1", 2),
    "COLOR_0": ("colour_0", 4),
    **{name: (name.lower(), 4) for name in INFLUENCES},
    LINE_OTHER: ("line_other", 4),
}


class _Key(Struct, frozen=True):
    """A primitive's geometry and the attributes of it that are uploaded."""

    geometry: object
    wanted: tuple[str, ...]


class Upload(Struct):
    """Meshes that share buffers, and where their vertices begin."""

    meshes: dict[_Key, Handle]
    descriptors: dict[_Key, MeshDescriptor]
    buffers: list[Handle]
    vertices: int
    indices: int


class JoinedMeshes(Struct, frozen=True, eq=False):
    """Meshes of one pair of buffers, which hold ``vertices`` and ``indices``.

    ``members`` are in the order that they were asked for.
    """

    members: list[MeshDescriptor]
    vertices: int
    indices: int


# A primitive, and the attributes of it that are uploaded.
Wanted = tuple[Primitive, tuple[str, ...]]


class GeometryPool:
    """The meshes of one device, by primitive and attributes.

    What was uploaded together is freed together, once nothing uses it.
    """

    def __init__(self, device: GraphicsDevice) -> None:
        self._device = device
        self._uploads: list[Upload] = []
        self._meshes: dict[_Key, Handle] = {}

    def meshes(self, wanted: Sequence[Wanted]) -> list[Handle]:
        """The meshes of these primitives, in order.

        What is missing is uploaded; what is not asked for again is freed.
        """
        keys = [_key(each) for each in wanted]
        used = set(keys)
        for upload in list(self._uploads):
            if used.isdisjoint(upload.meshes):
                self._free(upload)
        self.adopt(self.make(wanted))
        return [self._meshes[key] for key in keys]

    def make(
        self,
        wanted: Sequence[Wanted],
        told: Callable[[int, int], None] | None = None,
    ) -> list[Upload]:
        """Upload what is missing, for :meth:`adopt`; on any thread.

        ``told`` gets how many primitives are done, and of how many.
        """
        missing = {
            key: each[0]
            for each in wanted
            if (key := _key(each)) not in self._meshes
        }
        groups: dict[tuple[tuple[str, ...], bool], dict[_Key, Vertices]] = (
            defaultdict(dict)
        )
        for done, (key, primitive) in enumerate(missing.items()):
            if told is not None:
                told(done, len(missing))
            vertices = vertices_of(primitive, key.wanted)
            groups[key.wanted, vertices.indices is not None][key] = vertices
        return [_upload(self._device, members) for members in groups.values()]

    def adopt(self, uploads: Iterable[Upload]) -> None:
        """Have what was made; it is freed unless it is asked for next."""
        for upload in uploads:
            if self._meshes.keys().isdisjoint(upload.meshes):
                self._uploads.append(upload)
                self._meshes.update(upload.meshes)
            else:  # somebody was faster
                self._destroy(upload)

    def base_vertex(self, primitive: Primitive, wanted: tuple[str, ...]) -> int:
        """Where a primitive's vertices begin in the buffer it shares.

        What :meth:`meshes` was last asked for.
        """
        (upload,) = self._uploads_of([(primitive, wanted)])
        return upload.descriptors[_key((primitive, wanted))].base_vertex

    def joined_size(self, wanted: Sequence[Wanted]) -> tuple[int, int] | None:
        """Vertices and indices, at most, of the one pair of buffers they share.

        None where they do not, and will not, share one: those of one layout
        do that are uploaded together, all of them with indices.
        """
        uploads = self._uploads_of(wanted)
        if not uploads:
            if not all(map(_has_indices, wanted)):
                return None
            # To make tangents can give each corner a vertex of its own.
            corners = [
                max(each.index_count, each.vertex_count)
                for each in {_key(pair): pair[0] for pair in wanted}.values()
            ]
            return sum(corners), sum(corners)
        (first, *others) = uploads
        if (
            others
            or not first.indices
            or any(_key(each) not in first.meshes for each in wanted)
        ):
            return None
        return first.vertices, first.indices

    def joined(self, wanted: Sequence[Wanted]) -> JoinedMeshes:
        """The meshes of ``wanted``, which share buffers, after the upload."""
        (upload,) = self._uploads_of(wanted)
        return JoinedMeshes(
            [upload.descriptors[_key(each)] for each in wanted],
            upload.vertices,
            upload.indices,
        )

    def _uploads_of(self, wanted: Sequence[Wanted]) -> list[Upload]:
        keys = {_key(each) for each in wanted}
        return [
            upload
            for upload in self._uploads
            if not keys.isdisjoint(upload.meshes)
        ]

    def _free(self, upload: Upload) -> None:
        for key in upload.meshes:
            del self._meshes[key]
        self._uploads.remove(upload)
        self._destroy(upload)

    def _destroy(self, upload: Upload) -> None:
        self._device.destroy(*upload.meshes.values(), *upload.buffers)


def _key(wanted: Wanted) -> _Key:
    primitive, attributes = wanted
    return _Key(primitive.geometry, attributes)


def _has_indices(wanted: Wanted) -> bool:
    """Whether it is drawn with indices: its own, or those of its tangents."""
    primitive, attributes = wanted
    return primitive.indices is not None or any(
        name in MADE_TANGENTS for name in attributes
    )


def vertex_layout(wanted: Sequence[str]) -> VertexLayout:
    """The interleaved float32 layout of these glTF attributes."""
    attributes = []
    offset = 0
    for name in wanted:
        shader_name, components = _ATTRIBUTES[name]
        attributes.append(
            VertexAttribute(shader_name, "f4", components, offset)
        )
        offset += 4 * components
    return VertexLayout(tuple(attributes), offset)


def _upload(device: GraphicsDevice, members: Mapping[_Key, Vertices]) -> Upload:
    """One vertex and one index buffer for vertices of one layout."""
    wanted = next(iter(members)).wanted
    layout = vertex_layout(wanted)
    vertex_buffer = _buffer(
        device,
        BufferUsage.VERTEX,
        _interleave(list(members.values()), wanted, layout.stride // 4),
    )
    buffers = [vertex_buffer]
    index_buffer, index_type = None, IndexType.UINT32
    indices = [
        vertices.indices
        for vertices in members.values()
        if vertices.indices is not None
    ]
    if indices:
        # 16 bits if every primitive's own vertices can be counted with them.
        if max(vertices.count for vertices in members.values()) <= 0xFFFF:
            index_type = IndexType.UINT16
        joined = np.concatenate(
            indices, dtype=index_type.value, casting="unsafe"
        )
        index_buffer = _buffer(device, BufferUsage.INDEX, joined)
        buffers.append(index_buffer)
    meshes, descriptors = {}, {}
    base_vertex = first = 0
    for key, vertices in members.items():
        order = vertices.indices
        count = vertices.count if order is None else len(order)
        descriptors[key] = MeshDescriptor(
            vertices.topology,
            count,
            first,
            base_vertex,
            vertex_buffer,
            layout,
            index_buffer,
            index_type,
        )
        meshes[key] = device.create_mesh(descriptors[key])
        base_vertex += vertices.count
        first += count if indices else 0
    return Upload(meshes, descriptors, buffers, base_vertex, first)


def _interleave(
    members: Sequence[Vertices], wanted: Sequence[str], width: int
) -> NDArray[np.float32]:
    """Their vertices one after the other, ``width`` floats each.

    Written straight to their place: a cloud of ten million points is not
    copied twice.
    """
    joined = np.empty((sum(each.count for each in members), width), np.float32)
    end = 0
    for vertices in members:
        first, end = end, end + vertices.count
        column = 0
        for name in wanted:
            array = vertices.attributes[name]
            joined[first:end, column : column + array.shape[1]] = array
            column += array.shape[1]
    return joined.reshape(-1)


def _buffer(
    device: GraphicsDevice, usage: BufferUsage, data: NDArray[Any]
) -> Handle:
    return device.create_buffer(BufferDescriptor(usage, data.nbytes), data)
