"""Vertex arrays: which buffers feed the attributes of a program."""

from collections.abc import Callable
from typing import Any

from msgspec import Struct

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.gl_programs import GlProgram
from moka.commands.descriptors import IndexType, Topology, VertexLayout
from moka.commands.draws import INSTANCE
from moka.commands.handles import Handle
from moka.core.errors import DeviceError

__all__ = ["VertexSource", "bind_instances", "make_vertex_array"]

# How the vertex shader reads a row of moka.commands.draws.INSTANCE: four
# floats, or whole numbers, from a byte on.
_INSTANCE_ATTRIBUTES = {
    "instance_row_0": (c.FLOAT, 0),
    "instance_row_1": (c.FLOAT, 16),
    "instance_row_2": (c.FLOAT, 32),
    "instance_data": (c.UNSIGNED_INT, 48),
}


class VertexSource(Struct, frozen=True):
    """What must be bound to draw meshes: buffers, layout, topology."""

    topology: Topology
    layout: VertexLayout | None
    vertex_buffer: Handle | None
    index_buffer: Handle | None
    index_type: IndexType


def make_vertex_array(
    gl: Functions,
    program: GlProgram,
    source: VertexSource,
    buffers: Callable[[Handle], Any],
    instances: Any,
) -> int:
    """The name of a vertex array that feeds ``program`` from ``source``.

    It stays bound; instance 0 is the first row of ``instances``. Raises
    DeviceError if the program reads an attribute that neither the layout nor
    the instances have.
    """
    layout = None if source.vertex_buffer is None else source.layout
    attributes = () if layout is None else layout.attributes
    missing = program.attributes.keys() - _INSTANCE_ATTRIBUTES.keys()
    missing.difference_update(each.name for each in attributes)
    if missing:
        raise DeviceError(
            f"program {program.label}: reads attribute "
            f"{min(missing)!r}, which the mesh does not hold"
        )
    array = gl.make("VertexArrays")
    gl.BindVertexArray(array)
    if source.index_buffer is not None:
        indices = buffers(source.index_buffer).glo
        gl.BindBuffer(c.ELEMENT_ARRAY_BUFFER, indices)
    if layout is not None and source.vertex_buffer is not None:
        gl.BindBuffer(c.ARRAY_BUFFER, buffers(source.vertex_buffer).glo)
        for attribute in attributes:
            location = program.attributes.get(attribute.name)
            if location is None:
                continue
            gl.VertexAttribPointer(
                location,
                attribute.components,
                c.COMPONENT_TYPE[attribute.type],
                attribute.normalised,
                layout.stride,
                attribute.offset,
            )
            gl.EnableVertexAttribArray(location)
    for name in program.attributes.keys() & _INSTANCE_ATTRIBUTES.keys():
        location = program.attributes[name]
        gl.EnableVertexAttribArray(location)
        gl.VertexAttribDivisor(location, 1)
    bind_instances(gl, program, instances, 0)
    return array


def bind_instances(
    gl: Functions, program: GlProgram, instances: Any, first: int
) -> None:
    """Let instance 0 be row ``first`` of ``instances``.

    In the vertex array that is bound, which was made for ``program``.
    """
    gl.BindBuffer(c.ARRAY_BUFFER, instances.glo)
    stride = INSTANCE.itemsize
    for name, (kind, offset) in _INSTANCE_ATTRIBUTES.items():
        location = program.attributes.get(name)
        if location is None:
            continue
        place = first * stride + offset
        if kind == c.FLOAT:
            gl.VertexAttribPointer(location, 4, kind, False, stride, place)
        else:
            gl.VertexAttribIPointer(location, 4, kind, stride, place)
