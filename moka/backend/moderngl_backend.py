"""The backend over ModernGL: GL's objects by their handles, and frames.

All of it is called on the render thread. GL 3.3 core is enough.
"""

import contextlib
import time
from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from moka.backend import gl_constants as c
from moka.backend.contexts import GraphicsContext, WindowContext
from moka.backend.gl_buffer_texture import GlBufferTexture
from moka.backend.gl_commands import CommandRunner
from moka.backend.gl_draws import DrawRunner
from moka.backend.gl_functions import Functions
from moka.backend.gl_info import read_info
from moka.backend.gl_programs import BindingPoints, Explain, GlProgram
from moka.backend.gl_readback import PixelReader
from moka.backend.gl_state import StateCache
from moka.backend.gl_textures import GlFramebuffer, GlTexture, SamplerCache
from moka.backend.protocol import FrameCounters, TextureData
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BufferDescriptor,
    FramebufferDescriptor,
    MeshDescriptor,
    ProgramDescriptor,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.handles import Handle, ResourceKind
from moka.commands.recording import DrawSpan, Recording
from moka.core.errors import DeviceError, ShaderError
from moka.core.heap import keep_large_blocks

__all__ = ["ModernGLBackend"]


# Bytes from which the copy of a buffer is felt by other threads.
_LARGE_UPLOAD = 1 << 20


class ModernGLBackend:
    """Implements :class:`moka.backend.protocol.Backend`.

    ``explain`` turns a driver's shader log into one line that names file
    and line; ``multi_draw`` and ``clip_control`` can be turned off to run as
    on a driver of GL 3.3 that has neither. ``asynchronous`` is whether
    pixels are read back while later frames are drawn, by default if a GPU
    draws them.
    """

    def __init__(
        self,
        context: GraphicsContext,
        explain: Explain,
        *,
        multi_draw: bool = True,
        clip_control: bool = True,
        asynchronous: bool | None = None,
    ) -> None:
        self._context = context
        self._ctx = cast(Any, context.gl)
        # Every object is released here, by its handle; the collector, which
        # may run on any thread, releases none.
        self._ctx.gc_mode = None
        self._gl = Functions(context.function)
        self._explain = explain
        self.info = read_info(
            context, multi_draw=multi_draw, clip_control=clip_control
        )
        self._state = StateCache(self._gl)
        self._samplers = SamplerCache(self._gl, self.info.max_anisotropy)
        self._points = BindingPoints()
        # Programs that nobody has asked whether they are linked.
        self._begun: dict[Handle, GlProgram] = {}
        # Resources by the slots of their handles.
        self._resources: dict[tuple[ResourceKind, int], Any] = {}
        self._draws = DrawRunner(
            self._ctx,
            self._gl,
            self._state,
            self._samplers,
            self._resources,
            multi_draw=self.info.multi_draw_indirect,
        )
        self._uploaded = 0
        self._closed = False
        self._seconds: dict[str, float] = {}
        if asynchronous is None:
            asynchronous = not self.info.is_software
        self._reader = PixelReader(
            self._gl,
            (lambda size: self._ctx.buffer(reserve=size))
            if asynchronous
            else None,
        )
        self._runner = CommandRunner(
            self._gl, self._state, self._get, self._reader
        )
        keep_large_blocks()
        self._set_defaults()

    def create_buffer(
        self, handle: Handle, descriptor: BufferDescriptor, data: Any
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        if data is None:
            buffer = self._ctx.buffer(
                reserve=descriptor.size, dynamic=descriptor.dynamic
            )
        else:
            size = memoryview(data).nbytes
            if size != descriptor.size:
                raise DeviceError(
                    f"buffer {descriptor.label}: {size} bytes given for "
                    f"{descriptor.size}"
                )
            with self._timed("upload"):
                buffer = self._filled_buffer(data, size, descriptor)
            self._uploaded += size
        self._put(handle, buffer)

    def _filled_buffer(
        self, data: Any, size: int, descriptor: BufferDescriptor
    ) -> Any:
        if size < _LARGE_UPLOAD:
            return self._ctx.buffer(data, dynamic=descriptor.dynamic)
        # Without Python's lock, which ModernGL would hold all the time.
        buffer = self._ctx.buffer(reserve=size, dynamic=descriptor.dynamic)
        self._gl.BindBuffer(c.ARRAY_BUFFER, buffer.glo)
        source = np.frombuffer(data, np.uint8)
        self._gl.BufferSubData(c.ARRAY_BUFFER, 0, size, source.ctypes.data)
        return buffer

    def create_texture(
        self,
        handle: Handle,
        descriptor: TextureDescriptor,
        data: TextureData | None,
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        is_buffer = descriptor.kind is TextureKind.BUFFER
        largest = self.info.max_texture_size
        if is_buffer:
            largest = self.info.max_buffer_texels
        if max(descriptor.width, descriptor.height) > largest:
            raise DeviceError(
                f"texture {descriptor.label}: {descriptor.width}x"
                f"{descriptor.height} is larger than this driver's "
                f"{largest}"
            )
        with self._timed("upload"):
            texture: GlTexture | GlBufferTexture
            if is_buffer:
                over = descriptor.over
                texture = GlBufferTexture(
                    self._gl,
                    descriptor,
                    data,
                    None if over is None else self._get(over).glo,
                )
            else:
                texture = GlTexture(self._gl, descriptor, data)
            self._put(handle, texture)
        self._uploaded += sum(level.nbytes for level in data or ())
        self._check_errors(f"texture {descriptor.label}")

    def create_program(
        self, handle: Handle, descriptor: ProgramDescriptor
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        with self._timed("compile"):
            program = GlProgram(self._gl, descriptor)
        self._put(handle, program)
        self._begun[handle] = program

    def finish_programs(self, handles: Sequence[Handle] | None = None) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        if not self._begun:
            return
        with self._timed("compile"):
            for handle in tuple(self._begun) if handles is None else handles:
                try:
                    self._begun.pop(handle).finish(self._points, self._explain)
                except ShaderError:
                    self.destroy(handle)
                    # The driver reports the same fault as a debug message.
                    self._context.drain_debug_messages()
                    raise
        self._state.forget("program")

    def create_mesh(self, handle: Handle, descriptor: MeshDescriptor) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        self._draws.add_mesh(handle, descriptor)

    def create_framebuffer(
        self, handle: Handle, descriptor: FramebufferDescriptor
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        self._state.forget("framebuffer")
        self._put(handle, GlFramebuffer(self._gl, descriptor, self._get))

    def create_bind_group(
        self, handle: Handle, descriptor: BindGroupDescriptor
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        self._put(handle, descriptor)

    def destroy(self, handle: Handle) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        resource = self._resources.pop((handle.kind, handle.index), None)
        self._begun.pop(handle, None)
        self._draws.forget(handle)
        if resource is not None and hasattr(resource, "release"):
            resource.release()
        # GL names are reused: what the cache says is bound may be gone.
        self._state.forget()

    def execute(
        self, recording: Recording, stage: str = "frame"
    ) -> FrameCounters:
        """See :class:`moka.backend.protocol.Backend`."""
        self.finish_programs()
        start = time.perf_counter()
        counters = self._execute(recording)
        if stage != "frame":
            # Nobody reads the counters of these.
            self._uploaded = counters.bytes_uploaded
        spent = time.perf_counter() - start
        reading = self._reader.seconds
        if reading:
            self.add_time("readback", reading)
        self.add_time(stage, spent - reading)
        self._reader.seconds = 0.0
        return counters

    def _execute(self, recording: Recording) -> FrameCounters:
        self._runner.collect_times()
        counters = FrameCounters(bytes_uploaded=self._uploaded)
        self._uploaded = 0
        begun = len(self._reader)
        self._state.counters = counters
        counters.draw_packets = len(recording.draws)
        batches = self._draws.begin(recording, counters)
        for step in recording.steps:
            if isinstance(step, DrawSpan):
                for batch in batches.of_span[step.start]:
                    self._draws.draw(batches, batch, recording, counters)
            else:
                self._runner.run(step)
        # What frames before this one read, now that the GPU has work again.
        self._reader.take(begun)
        counters.bytes_uploaded += self._uploaded + self._runner.uploaded
        self._uploaded = self._runner.uploaded = 0
        self._check_errors("frame")
        return counters

    def read_texture(
        self, handle: Handle, level: int, face: int
    ) -> NDArray[Any]:
        """See :class:`moka.backend.protocol.Backend`."""
        texels: NDArray[Any] = self._get(handle).read(level, face)
        self._check_errors("read_texture")
        return texels

    def add_time(self, stage: str, seconds: float) -> None:
        """Count ``seconds`` for ``stage`` in :meth:`stage_seconds`."""
        self._seconds[stage] = self._seconds.get(stage, 0.0) + seconds

    def stage_seconds(self) -> dict[str, float]:
        """See :class:`moka.backend.protocol.Backend`.

        A recording's time is the thread's own: the GPU may still be busy
        when it ends, and then the next one that reads back waits for it.
        """
        return dict(self._seconds)

    def finish(self) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        self._gl.Finish()
        self._reader.take()

    def poll(self) -> bool:
        """See :class:`moka.backend.protocol.Backend`."""
        return self._reader.take(timeout=0)

    def present(self) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        if not isinstance(self._context, WindowContext):
            raise DeviceError("only the device of a window can present")
        self._context.swap()

    def close(self) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        if self._closed:
            return
        self._closed = True
        with contextlib.suppress(Exception):
            self._draws.release()
            for resource in self._resources.values():
                if hasattr(resource, "release"):
                    resource.release()
            self._samplers.release()
            self._reader.release()
            self._runner.release()
        self._resources.clear()
        self._begun.clear()
        self._context.close()

    def _set_defaults(self) -> None:
        """Set what no draw and no command changes."""
        gl = self._gl
        gl.PixelStorei(c.UNPACK_ALIGNMENT, 1)
        gl.PixelStorei(c.PACK_ALIGNMENT, 1)
        gl.Enable(c.TEXTURE_CUBE_MAP_SEAMLESS)
        gl.Enable(c.PROGRAM_POINT_SIZE)
        gl.Disable(c.FRAMEBUFFER_SRGB)
        if self.info.clip_control:
            # Depth from 0 to 1, so that reversed depth keeps its precision.
            gl.ClipControl(c.LOWER_LEFT, c.ZERO_TO_ONE)

    @contextlib.contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        start = time.perf_counter()
        try:
            yield
        finally:
            self.add_time(stage, time.perf_counter() - start)

    def _put(self, handle: Handle, resource: Any) -> None:
        self._resources[handle.kind, handle.index] = resource

    def _get(self, handle: Handle) -> Any:
        return self._resources[handle.kind, handle.index]

    def _check_errors(self, what: str) -> None:
        messages = self._context.drain_debug_messages()
        for message in messages:
            if message.is_error:
                # It may be about a shader that nobody has asked about yet.
                self.finish_programs()
                raise DeviceError(f"{what}: OpenGL reports {message}")
