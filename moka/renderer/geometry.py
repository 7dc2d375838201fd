"""Puts primitives into shared vertex and index buffers.

All primitives of a model that have one vertex layout share one pair of
buffers and differ by base vertex and first index, so that one GL call can
draw many of them. Only attributes that the material's shader reads are
uploaded.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    BufferDescriptor,
    BufferUsage,
    IndexType,
    MeshDescriptor,
    Topology,
    VertexAttribute,
    VertexLayout,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = ["GeometryRequest", "UploadedGeometry", "upload_geometry"]

# glTF attribute: shader input, components. All are float32 on the GPU.
_ATTRIBUTES = {
    "POSITION": ("position", 3),
    "NORMAL": ("normal", 3),
    "TANGENT": ("tangent", 4),
    "TEXCOORD_0": ("uv_0", 2),
    "TEXCOORD_1": ("uv_1", 2),
    "COLOR_0": ("colour_0", 4),
}


@dataclass(frozen=True, slots=True)
class GeometryRequest:
    """A primitive's arrays and the glTF attributes that are wanted."""

    topology: Topology
    attributes: Mapping[str, NDArray[Any]]
    indices: NDArray[Any] | None
    wanted: tuple[str, ...]

    @property
    def vertex_count(self) -> int:
        """How many vertices the arrays hold."""
        return len(self.attributes["POSITION"])


@dataclass(frozen=True, slots=True)
class UploadedGeometry:
    """Meshes in the order of the requests, and all handles to destroy."""

    meshes: tuple[Handle, ...]
    buffers: tuple[Handle, ...]


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


def upload_geometry(
    device: GraphicsDevice, requests: Sequence[GeometryRequest]
) -> UploadedGeometry:
    """Make the meshes of ``requests``; two buffers per vertex layout."""
    groups: dict[tuple[tuple[str, ...], bool], list[int]] = defaultdict(list)
    for number, request in enumerate(requests):
        groups[request.wanted, request.indices is not None].append(number)
    meshes: dict[int, Handle] = {}
    buffers: list[Handle] = []
    for (wanted, indexed), numbers in groups.items():
        members = [requests[number] for number in numbers]
        layout = vertex_layout(wanted)
        vertex_buffer = _buffer(
            device,
            BufferUsage.VERTEX,
            np.concatenate([_interleave(member) for member in members]),
        )
        buffers.append(vertex_buffer)
        index_buffer, index_type = None, IndexType.UINT32
        if indexed:
            index_type = _index_type(members)
            indices = np.concatenate(
                [np.asarray(member.indices).ravel() for member in members],
                dtype=index_type.value,
                casting="unsafe",
            )
            index_buffer = _buffer(device, BufferUsage.INDEX, indices)
            buffers.append(index_buffer)
        base_vertex = first = 0
        for number, member in zip(numbers, members, strict=True):
            count = (
                member.vertex_count
                if member.indices is None
                else member.indices.size
            )
            meshes[number] = device.create_mesh(
                MeshDescriptor(
                    member.topology,
                    count,
                    first,
                    base_vertex,
                    vertex_buffer,
                    layout,
                    index_buffer,
                    index_type,
                )
            )
            base_vertex += member.vertex_count
            first += count if indexed else 0
    return UploadedGeometry(
        tuple(meshes[number] for number in range(len(requests))),
        tuple(buffers),
    )


def _interleave(request: GeometryRequest) -> NDArray[np.float32]:
    columns = [request.attributes[name] for name in request.wanted]
    vertices = np.empty(
        (request.vertex_count, sum(c.shape[1] for c in columns)), np.float32
    )
    start = 0
    for column in columns:
        vertices[:, start : start + column.shape[1]] = column
        start += column.shape[1]
    return vertices.reshape(-1)


def _index_type(members: Sequence[GeometryRequest]) -> IndexType:
    """16 bits if every primitive's own vertices can be counted with them."""
    largest = max(member.vertex_count for member in members)
    return IndexType.UINT16 if largest <= 0xFFFF else IndexType.UINT32


def _buffer(
    device: GraphicsDevice, usage: BufferUsage, data: NDArray[Any]
) -> Handle:
    return device.create_buffer(BufferDescriptor(usage, data.nbytes), data)
