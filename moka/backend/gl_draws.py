"""Executes draws, batch by batch.

Where the driver has multi-draw-indirect with a base instance (4.3), a batch
of any size is one call; below, it is one call per mesh, with the instance
attributes pointed at its rows.
"""

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from moka.backend import gl_constants as c
from moka.backend.batching import INDIRECT, Batches, MeshTable, merge_draws
from moka.backend.gl_bindings import Bindings, match_bindings
from moka.backend.gl_functions import Functions
from moka.backend.gl_programs import GlProgram
from moka.backend.gl_state import StateCache
from moka.backend.gl_textures import SamplerCache
from moka.backend.gl_vertex_arrays import (
    VertexSource,
    bind_instances,
    make_vertex_array,
)
from moka.backend.protocol import FrameCounters
from moka.commands.descriptors import MeshDescriptor
from moka.commands.draws import INSTANCE
from moka.commands.handles import Handle, ResourceKind
from moka.commands.recording import Recording

__all__ = ["DrawRunner"]

_T = TypeVar("_T")


class DrawRunner:
    """Runs batches of draws, and keeps what their parts have in common.

    That is of a program and a vertex source an array, of a program and a
    bind group what is bound where. ``resources`` are the GL objects, by the
    slots of their handles.
    """

    def __init__(
        self,
        context: Any,
        gl: Functions,
        state: StateCache,
        samplers: SamplerCache,
        resources: Mapping[tuple[ResourceKind, int], Any],
        *,
        multi_draw: bool,
    ) -> None:
        self._gl = gl
        self._state = state
        self._samplers = samplers
        self._resources = resources
        self._has_multi_draw = multi_draw
        self._meshes = MeshTable()
        self._sources: list[VertexSource] = []
        self._source_numbers: dict[VertexSource, int] = {}
        self._bindings: dict[tuple[int, int], Bindings] = {}
        self._arrays: dict[tuple[int, int], int] = {}
        self._instances = context.buffer(
            reserve=INSTANCE.itemsize, dynamic=True
        )
        self._commands = context.buffer(reserve=INDIRECT.itemsize, dynamic=True)

    def add_mesh(self, handle: Handle, descriptor: MeshDescriptor) -> None:
        """Draw ``descriptor`` where ``handle`` is named."""
        source = VertexSource(
            descriptor.topology,
            descriptor.layout,
            descriptor.vertex_buffer,
            descriptor.index_buffer,
            descriptor.index_type,
        )
        number = self._source_numbers.setdefault(source, len(self._sources))
        if number == len(self._sources):
            self._sources.append(source)
        self._meshes.put(
            handle.index,
            count=descriptor.count,
            first=descriptor.first,
            base_vertex=descriptor.base_vertex,
            source=number,
            indexed=descriptor.index_buffer is not None,
        )

    def forget(self, handle: Handle) -> None:
        """Drop what is kept of a resource that goes."""
        if handle.kind is ResourceKind.PROGRAM:
            _drop(self._bindings, 0, handle.index)
            self._drop_arrays(0, handle.index)
        elif handle.kind is ResourceKind.BIND_GROUP:
            _drop(self._bindings, 1, handle.index)
        elif handle.kind is ResourceKind.BUFFER:
            self._drop_sources(handle)

    def begin(self, recording: Recording, counters: FrameCounters) -> Batches:
        """The batches of a recording, whose instances are uploaded."""
        batches = merge_draws(recording, self._meshes)
        self._upload(recording.instances, self._instances, counters)
        if self._has_multi_draw:
            self._upload(batches.commands, self._commands, counters)
            self._gl.BindBuffer(c.DRAW_INDIRECT_BUFFER, self._commands.glo)
        return batches

    def draw(
        self,
        batches: Batches,
        batch: int,
        recording: Recording,
        counters: FrameCounters,
    ) -> None:
        """Draw one of the batches of ``recording``."""
        slot = batches.program[batch]
        program: GlProgram = self._resources[ResourceKind.PROGRAM, slot]
        number = batches.source[batch]
        source = self._sources[number]
        state = self._state
        array = self._arrays.get((slot, number))
        if array is None:
            array = self._arrays[slot, number] = make_vertex_array(
                self._gl, program, source, self._get, self._instances
            )
            state.forget("vertex_array")
        state.program(program.name)
        state.vertex_array(array)
        state.raster(recording.states[batches.state[batch]])
        self._bind(slot, program, batches.bind_group[batch])
        first, last = batches.start[batch], batches.start[batch + 1]
        if self._has_multi_draw:
            self._multi_draw(source, first, last - first)
            counters.gl_draws += 1
            return
        for command in batches.commands[first:last]:
            self._single_draw(program, source, command)
            counters.gl_draws += 1

    def release(self) -> None:
        """Delete the GL objects."""
        for array in self._arrays.values():
            self._gl.delete("VertexArrays", array)
        self._arrays.clear()
        self._instances.release()
        self._commands.release()

    def _get(self, handle: Handle) -> Any:
        return self._resources[handle.kind, handle.index]

    def _drop_arrays(self, part: int, slot: int) -> None:
        for array in _drop(self._arrays, part, slot):
            self._gl.delete("VertexArrays", array)

    def _drop_sources(self, buffer: Handle) -> None:
        for source in [
            source
            for source in self._source_numbers
            if buffer in (source.vertex_buffer, source.index_buffer)
        ]:
            # Numbers are never given out again, so that a mesh that still
            # names one cannot draw from another buffer.
            self._drop_arrays(1, self._source_numbers.pop(source))

    @staticmethod
    def _upload(
        rows: NDArray[Any], buffer: Any, counters: FrameCounters
    ) -> None:
        if not len(rows):
            return
        # Orphaning lets the driver keep the last frame's copy while it is
        # still being drawn from.
        buffer.orphan(rows.nbytes)
        buffer.write(np.ascontiguousarray(rows))
        counters.bytes_uploaded += rows.nbytes

    def _bind(self, slot: int, program: GlProgram, group: int) -> None:
        bindings = self._bindings.get((slot, group))
        if bindings is None:
            bindings = self._bindings[slot, group] = match_bindings(
                program,
                self._resources[ResourceKind.BIND_GROUP, group],
                self._get,
                self._get,
                self._samplers,
            )
        for texture in bindings.textures:
            self._state.texture(*texture)
        for block in bindings.blocks:
            self._state.uniform_block(*block)

    def _multi_draw(self, source: VertexSource, first: int, count: int) -> None:
        offset = first * INDIRECT.itemsize
        mode = c.TOPOLOGY[source.topology]
        if source.index_buffer is None:
            self._gl.MultiDrawArraysIndirect(
                mode, offset, count, INDIRECT.itemsize
            )
        else:
            self._gl.MultiDrawElementsIndirect(
                mode,
                c.INDEX_TYPE[source.index_type],
                offset,
                count,
                INDIRECT.itemsize,
            )

    def _single_draw(
        self, program: GlProgram, source: VertexSource, command: Any
    ) -> None:
        mode = c.TOPOLOGY[source.topology]
        if source.index_buffer is None:
            # Without indices the base instance is the fourth word.
            first_instance = int(command["base_vertex"])
        else:
            first_instance = int(command["base_instance"])
        bind_instances(self._gl, program, self._instances, first_instance)
        count, instances = int(command["count"]), command["instance_count"]
        if source.index_buffer is None:
            self._gl.DrawArraysInstanced(
                mode, int(command["first"]), count, int(instances)
            )
        else:
            width = np.dtype(source.index_type.value).itemsize
            self._gl.DrawElementsInstancedBaseVertex(
                mode,
                count,
                c.INDEX_TYPE[source.index_type],
                int(command["first"]) * width,
                int(instances),
                int(command["base_vertex"]),
            )


def _drop(cache: dict[tuple[int, int], _T], part: int, slot: int) -> list[_T]:
    """Take out what is kept of a slot; ``part`` says which of a key's it is."""
    return [cache.pop(key) for key in list(cache) if key[part] == slot]
