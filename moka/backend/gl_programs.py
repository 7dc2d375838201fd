"""Programs, bind groups and vertex sources, and how they fit together.

A program names its textures, blocks and attributes; bind groups and vertex
layouts answer by name. Each pair is matched once, when it first meets.
"""

from collections.abc import Callable
from typing import Any

from msgspec import Struct

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.gl_textures import GlTexture, SamplerCache
from moka.commands.descriptors import (
    BindGroupDescriptor,
    IndexType,
    ProgramDescriptor,
    Topology,
    VertexLayout,
)
from moka.commands.draws import INSTANCE
from moka.commands.handles import Handle
from moka.core.errors import DeviceError, ShaderError

__all__ = [
    "Bindings",
    "BlockRegistry",
    "GlProgram",
    "VertexSource",
    "make_vertex_array",
    "match_bindings",
]

# How the vertex shader reads a row of moka.commands.draws.INSTANCE.
INSTANCE_ATTRIBUTES = (
    ("instance_row_0", "f", "4f", 0),
    ("instance_row_1", "f", "4f", 16),
    ("instance_row_2", "f", "4f", 32),
    ("instance_data", "i", "4u", 48),
)


class BlockRegistry:
    """Gives every uniform block name one binding point for all programs.

    So that a block which many programs share (the frame's) stays bound when
    the program changes.
    """

    def __init__(self) -> None:
        self._points: dict[str, int] = {}

    def __len__(self) -> int:
        """How many points have been given out, from 0."""
        return len(self._points)

    def point(self, name: str) -> int:
        """The binding point of the blocks called ``name``."""
        return self._points.setdefault(name, len(self._points))


class GlProgram:
    """A linked program and what it reads, by name."""

    def __init__(
        self,
        context: Any,
        gl: Functions,
        descriptor: ProgramDescriptor,
        blocks: BlockRegistry,
        explain: Callable[[str, ProgramDescriptor], str],
    ) -> None:
        from moderngl import Attribute, Error, Uniform, UniformBlock

        self.label = descriptor.label
        try:
            self.program = context.program(
                vertex_shader=descriptor.vertex.source,
                fragment_shader=descriptor.fragment.source,
            )
        except Error as error:
            raise ShaderError(explain(str(error), descriptor)) from None
        self.name: int = self.program.glo
        self.samplers: dict[str, int] = {}
        self.blocks: dict[str, tuple[int, int]] = {}
        self.attributes: dict[str, int] = {}
        for name in self.program:
            member = self.program[name]
            if isinstance(member, Attribute):
                self.attributes[name] = member.location
            elif isinstance(member, UniformBlock):
                member.binding = blocks.point(name)
                self.blocks[name] = (member.binding, member.size)
            elif isinstance(member, Uniform):
                # Plain uniforms are samplers here; values live in blocks.
                # ModernGL has no word for those of buffer textures.
                gl.UseProgram(self.name)
                gl.Uniform1i(member.location, len(self.samplers))
                self.samplers[name] = len(self.samplers)

    def release(self) -> None:
        """Delete the GL object."""
        self.program.release()


class Bindings(Struct, frozen=True):
    """What one bind group binds for one program.

    Arguments of :meth:`StateCache.texture` and ``uniform_block``.
    """

    textures: tuple[tuple[int, int, int, int, tuple[int, int]], ...]
    blocks: tuple[tuple[int, int, int, int], ...]


def match_bindings(
    program: GlProgram,
    group: BindGroupDescriptor,
    textures: Callable[[Handle], GlTexture],
    buffers: Callable[[Handle], Any],
    samplers: SamplerCache,
) -> Bindings:
    """Resolve ``group`` for ``program``; extra entries are left out.

    Raises DeviceError if the program reads something that the group lacks
    or a block is larger than its buffer range.
    """
    bound_textures = []
    by_name = {binding.name: binding for binding in group.textures}
    for name, unit in program.samplers.items():
        if name not in by_name:
            raise DeviceError(
                f"program {program.label}: reads texture {name!r}, which its "
                "bind group does not hold"
            )
        wanted = by_name[name]
        texture = textures(wanted.texture)
        last = texture.descriptor.level_count - 1
        levels = (0, last) if wanted.level is None else (wanted.level,) * 2
        sampler = samplers.name(wanted.sampler, levels[0] < levels[1])
        bound_textures.append(
            (unit, texture.target, texture.name, sampler, levels)
        )
    bound_blocks = []
    uniforms = {binding.name: binding for binding in group.uniforms}
    for name, (point, size) in program.blocks.items():
        if name not in uniforms:
            raise DeviceError(
                f"program {program.label}: reads block {name!r}, which its "
                "bind group does not hold"
            )
        binding = uniforms[name]
        buffer = buffers(binding.buffer)
        available = binding.size or buffer.size - binding.offset
        if available < size:
            raise DeviceError(
                f"program {program.label}: block {name!r} has {size} bytes, "
                f"its bind group gives {available}"
            )
        bound_blocks.append((point, buffer.glo, binding.offset, available))
    return Bindings(tuple(bound_textures), tuple(bound_blocks))


class VertexSource(Struct, frozen=True):
    """What must be bound to draw meshes: buffers, layout, topology."""

    topology: Topology
    layout: VertexLayout | None
    vertex_buffer: Handle | None
    index_buffer: Handle | None
    index_type: IndexType


def make_vertex_array(
    context: Any,
    gl: Functions,
    program: GlProgram,
    source: VertexSource,
    buffers: Callable[[Handle], Any],
    instances: Any,
) -> Any:
    """A vertex array that feeds ``program`` from ``source``.

    Raises DeviceError if the program reads an attribute that neither the
    layout nor the instances have.
    """
    index_buffer = (
        None if source.index_buffer is None else buffers(source.index_buffer)
    )
    array = context.vertex_array(program.program, [], index_buffer)
    missing = set(program.attributes)
    if source.layout is not None and source.vertex_buffer is not None:
        # ModernGL's own binding of attributes cannot normalise integers.
        gl.BindVertexArray(array.glo)
        gl.BindBuffer(c.ARRAY_BUFFER, buffers(source.vertex_buffer).glo)
        for attribute in source.layout.attributes:
            location = program.attributes.get(attribute.name)
            if location is None:
                continue
            gl.VertexAttribPointer(
                location,
                attribute.components,
                c.COMPONENT_TYPE[attribute.type],
                attribute.normalised,
                source.layout.stride,
                attribute.offset,
            )
            gl.EnableVertexAttribArray(location)
            missing.discard(attribute.name)
    bind_instances(array, program, instances, 0)
    missing.difference_update(name for name, *_ in INSTANCE_ATTRIBUTES)
    missing = {name for name in missing if not name.startswith("gl_")}
    if missing:
        raise DeviceError(
            f"program {program.label}: reads attribute "
            f"{min(missing)!r}, which the mesh does not hold"
        )
    return array


def bind_instances(
    array: Any, program: GlProgram, instances: Any, first: int
) -> None:
    """Let instance 0 of ``array`` be row ``first`` of ``instances``."""
    for name, kind, layout, offset in INSTANCE_ATTRIBUTES:
        location = program.attributes.get(name)
        if location is not None:
            array.bind(
                location,
                kind,
                instances,
                layout,
                first * INSTANCE.itemsize + offset,
                INSTANCE.itemsize,
                1,
                False,
            )
