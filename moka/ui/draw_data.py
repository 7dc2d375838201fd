"""Dear ImGui's draw data as arrays: every triangle of every panel, in order.

A command of Dear ImGui has a scissor rectangle; here each vertex carries it,
so that commands which share a texture, usually all of them, are one draw.
"""

import ctypes
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

__all__ = ["INDEX", "VERTEX", "Batch", "Geometry", "flatten"]

#: What Dear ImGui writes, and our clip rectangle: left, top, right, bottom.
_IMGUI_VERTEX = np.dtype(
    [
        ("position", np.float32, 2),
        ("uv", np.float32, 2),
        ("colour", np.uint8, 4),
    ]
)
VERTEX = np.dtype([*_IMGUI_VERTEX.descr, ("clip", np.float32, 4)])
INDEX = np.dtype(np.uint32)


class Batch(Struct, frozen=True):
    """A run of ``count`` indices from ``first`` that share a texture."""

    texture: int
    first: int
    count: int


class Geometry(Struct, frozen=True):
    """All vertices (V,) of VERTEX, indices (I,) of INDEX, and their batches."""

    vertices: NDArray[np.void]
    indices: NDArray[np.uint32]
    batches: tuple[Batch, ...]


def flatten(draw_data: Any) -> Geometry:
    """The geometry of an ``ImDrawData``; copied, since it is only lent."""
    vertices = np.empty(draw_data.total_vtx_count, VERTEX)
    indices = np.empty(draw_data.total_idx_count, INDEX)
    batches: list[Batch] = []
    first_vertex = first_index = 0
    for commands in draw_data.cmd_lists:
        lent = _lent(commands.vtx_buffer, _IMGUI_VERTEX)
        numbers = _lent(commands.idx_buffer, INDEX)
        here = vertices[first_vertex : first_vertex + len(lent)]
        for name in _IMGUI_VERTEX.names or ():
            here[name] = lent[name]
        for command in commands.cmd_buffer:
            used = numbers[command.idx_offset :][: command.elem_count]
            if not len(used):
                continue
            used = used + np.uint32(command.vtx_offset)
            rectangle = command.clip_rect
            # Vertices belong to one primitive, and so to one command.
            here["clip"][used] = (
                *(rectangle.x, rectangle.y),
                *(rectangle.z, rectangle.w),
            )
            end = first_index + len(used)
            np.add(used, first_vertex, out=indices[first_index:end])
            texture = command.get_tex_id()
            if batches and batches[-1].texture == texture:
                last = batches.pop()
                batches.append(
                    Batch(texture, last.first, last.count + len(used))
                )
            else:
                batches.append(Batch(texture, first_index, len(used)))
            first_index = end
        first_vertex += len(lent)
    return Geometry(vertices, indices[:first_index], tuple(batches))


def _lent(buffer: Any, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The elements of an ``ImVector`` in place."""
    count = buffer.size()
    if not count:
        return np.empty(0, dtype)
    memory = (ctypes.c_uint8 * (count * dtype.itemsize)).from_address(
        buffer.data_address()
    )
    return np.frombuffer(memory, dtype)
