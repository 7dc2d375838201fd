"""A backend without a GPU that writes down what it is asked to do.

It ships with moka, so that a user's own tests can assert packets too: what
was drawn, in which order, with which resources.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.backend.batching import Batches, MeshTable, merge_draws
from moka.backend.protocol import BackendInfo, FrameCounters, TextureData
from moka.commands.commands import (
    FillBuffer,
    FillTexture,
    ReadPixels,
    Timestamp,
)
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BufferDescriptor,
    FramebufferDescriptor,
    MeshDescriptor,
    ProgramDescriptor,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.handles import Handle
from moka.commands.recording import Recording

__all__ = ["RecordingBackend"]


class RecordingBackend:
    """Implements :class:`moka.backend.protocol.Backend` on paper.

    ``resources`` maps live handles to their descriptors, ``frames`` holds
    the executed recordings, ``batches`` how a GPU backend would have merged
    their draws. What is read back is zero, and so are times.
    """

    def __init__(self, info: BackendInfo | None = None) -> None:
        self.info = info or BackendInfo(kind="recording")
        self.resources: dict[Handle, Any] = {}
        self.contents: dict[Handle, bytes] = {}
        self.given_levels: dict[Handle, int] = {}
        self.frames: list[Recording] = []
        self.stages: list[str] = []
        self.batches: list[Batches] = []
        self.presented = 0
        self.closed = False
        self._meshes = MeshTable()
        self._sources: dict[Any, int] = {}

    def create_buffer(
        self, handle: Handle, descriptor: BufferDescriptor, data: Any
    ) -> None:
        """Keep the descriptor and a copy of the data."""
        self.resources[handle] = descriptor
        self.contents[handle] = (
            bytes(descriptor.size) if data is None else bytes(memoryview(data))
        )

    def create_texture(
        self,
        handle: Handle,
        descriptor: TextureDescriptor,
        data: TextureData | None,
    ) -> None:
        """Keep the descriptor and how many levels came with it."""
        self.resources[handle] = descriptor
        self.given_levels[handle] = len(data or ())

    def create_program(
        self, handle: Handle, descriptor: ProgramDescriptor
    ) -> None:
        """Keep the descriptor; nothing is compiled."""
        self.resources[handle] = descriptor

    def finish_programs(self, handles: Sequence[Handle] | None = None) -> None:
        """There is nothing to wait for."""

    def create_mesh(self, handle: Handle, descriptor: MeshDescriptor) -> None:
        """Keep the descriptor."""
        self.resources[handle] = descriptor
        source = (
            descriptor.topology,
            descriptor.layout,
            descriptor.vertex_buffer,
            descriptor.index_buffer,
            descriptor.index_type,
        )
        self._meshes.put(
            handle.index,
            count=descriptor.count,
            first=descriptor.first,
            base_vertex=descriptor.base_vertex,
            source=self._sources.setdefault(source, len(self._sources)),
            indexed=descriptor.index_buffer is not None,
        )

    def create_framebuffer(
        self, handle: Handle, descriptor: FramebufferDescriptor
    ) -> None:
        """Keep the descriptor."""
        self.resources[handle] = descriptor

    def create_bind_group(
        self, handle: Handle, descriptor: BindGroupDescriptor
    ) -> None:
        """Keep the descriptor."""
        self.resources[handle] = descriptor

    def destroy(self, handle: Handle) -> None:
        """Forget the resource."""
        del self.resources[handle]
        self.contents.pop(handle, None)
        self.given_levels.pop(handle, None)

    def execute(
        self, recording: Recording, stage: str = "frame"
    ) -> FrameCounters:
        """Keep the recording; fill buffers; answer read-backs with zeros."""
        self.frames.append(recording)
        self.stages.append(stage)
        batches = merge_draws(recording, self._meshes)
        self.batches.append(batches)
        uploaded = recording.instances.nbytes
        for step in recording.steps:
            if isinstance(step, FillBuffer):
                uploaded += len(step.data)
                before = self.contents[step.buffer]
                end = step.offset + len(step.data)
                self.contents[step.buffer] = (
                    before[: step.offset] + step.data + before[end:]
                )
            elif isinstance(step, FillTexture):
                uploaded += len(step.data)
            elif isinstance(step, ReadPixels):
                _, _, width, height = step.rectangle
                step.into.arrived.set_result(
                    np.zeros((height, width, step.channels), step.dtype)
                )
            elif isinstance(step, Timestamp):
                marks = step.into.marks or []
                step.into.marks = [*marks, (step.label, 0)]
        return FrameCounters(
            draw_packets=len(recording.draws),
            gl_draws=len(batches.program),
            bytes_uploaded=uploaded,
        )

    def read_texture(
        self, handle: Handle, level: int, face: int
    ) -> NDArray[Any]:
        """Zeros of the level's shape."""
        descriptor: TextureDescriptor = self.resources[handle]
        assert face == 0 or descriptor.kind is TextureKind.CUBE
        width, height = descriptor.level_size(level)
        return np.zeros(
            (height, width, descriptor.format.channels),
            descriptor.format.dtype,
        )

    def stage_seconds(self) -> dict[str, float]:
        """Nothing takes time on paper."""
        return {}

    def finish(self) -> None:
        """There is nothing to wait for."""

    def poll(self) -> bool:
        """What was asked for has been read at once."""
        return False

    def present(self) -> None:
        """Count the frame shown."""
        self.presented += 1

    def close(self) -> None:
        """Remember that it was closed."""
        self.closed = True
