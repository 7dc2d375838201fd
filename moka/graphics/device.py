"""GraphicsDevice: the application's side of the bridge to a backend.

Resources are made and lists are submitted on any thread; everything is
executed on the render thread in the order of the calls. The two sides meet
at the start of a frame: a submit waits for the frame before the last, so
that one frame at most is in flight while the next is recorded. A device that
is embedded in another program executes on that program's thread, at once.
"""

from __future__ import annotations

import concurrent.futures
import itertools
import threading
import time
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from moka.commands.handles import Handle, HandleAllocator, ResourceKind
from moka.core.errors import DeviceError
from moka.graphics.render_thread import RenderThread

# Of types alone: whoever opens a device need not wait for NumPy, which can be
# imported while the driver loads.
if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moka.backend.protocol import (
        Backend,
        BackendInfo,
        FrameCounters,
        TextureData,
    )
    from moka.commands.command_list import CommandList
    from moka.commands.commands import Readback
    from moka.commands.descriptors import (
        BindGroupDescriptor,
        BufferDescriptor,
        FramebufferDescriptor,
        MeshDescriptor,
        ProgramDescriptor,
        TextureDescriptor,
    )
    from moka.graphics.calling_thread import CallingThread

__all__ = ["Frame", "GraphicsDevice"]

T = TypeVar("T")

_device_numbers = itertools.count()


class Frame:
    """A submitted command list: wait for it, then read its counters."""

    def __init__(
        self,
        thread: RenderThread | CallingThread,
        future: Future[FrameCounters],
        reads: Sequence[Readback] = (),
    ) -> None:
        self._thread = thread
        self._future = future
        self._arriving: list[Future[Any]] = [read.arrived for read in reads]

    @property
    def is_done(self) -> bool:
        """Whether it has been executed, and what it reads has arrived."""
        return all(each.done() for each in (self._future, *self._arriving))

    def is_done_within(self, timeout: float) -> bool:
        """Whether that is so, or is ``timeout`` seconds from now."""
        awaited = (self._future, *self._arriving)
        return not concurrent.futures.wait(awaited, timeout).not_done

    def wait(self) -> FrameCounters:
        """Return when that is so; raise what it raised.

        To have pixels read while the GPU draws on, submit the next frame
        before.
        """
        counters = self.wait_for_execution()
        for each in self._arriving:
            self._thread.wait(each)
        return counters

    def wait_for_execution(self) -> FrameCounters:
        """Return when it has been executed; raise what it raised."""
        return self._thread.wait(self._future)


class GraphicsDevice:
    """Owns a backend on its render thread and the handles of its resources.

    ``open_backend`` is called on the render thread and makes the context
    there; a :class:`CallingThread` has its own and stands for that thread.
    Use :meth:`open` for a headless one, :meth:`embed` for one in another
    program's context. A device is closed by :meth:`close`, by leaving its
    ``with`` block, when it is collected and when the interpreter exits.
    """

    def __init__(
        self, open_backend: Callable[[], Backend] | CallingThread
    ) -> None:
        number = next(_device_numbers)
        self._handles = HandleAllocator(number)
        self._thread: RenderThread | CallingThread
        if callable(open_backend):
            self._thread = RenderThread(open_backend)
        else:
            self._thread = open_backend
        self._info: BackendInfo | None = None
        self._in_flight: Frame | None = None
        self._has_begun_programs = False
        self._checked: dict[frozenset[Handle], int] = {}
        self._releases = 0
        self._counting = threading.Lock()
        self._finalizer = weakref.finalize(self, self._thread.abandon)

    @classmethod
    def open(
        cls,
        backend: str = "auto",
        *,
        device: int | None = None,
        debug: bool = False,
    ) -> GraphicsDevice:
        """A headless device.

        ``backend`` is ``auto``, ``egl``, ``osmesa`` or ``window`` (hidden),
        ``device`` the number of an EGL device, ``debug`` turns GL debug
        output on and its errors into DeviceError. Returns at once; the
        first call that needs the context raises ContextError if none can be
        made.
        """

        def open_backend() -> Backend:
            from moka.backend.contexts import open_context

            start = time.perf_counter()
            context = open_context(backend, device=device, debug=debug)
            from moka.backend.moderngl_backend import ModernGLBackend
            from moka.graphics.shader_source import explain_log

            opened = ModernGLBackend(context, explain_log)
            opened.add_time("context", time.perf_counter() - start)
            return opened

        return cls(open_backend)

    @classmethod
    def embed(cls, context: Any) -> GraphicsDevice:
        """A device in another program's :class:`moderngl.Context`.

        ``context`` (OpenGL 3.3 or later) is current on this thread, here and
        at every call of the device; calls from other threads raise
        DeviceError. There is no render thread: whatever is asked for is done
        when the call returns, and OpenGL's state is then as it was: what is
        bound, blending, tests, masks, down to pixel stores.

        Where a window would be drawn into, the framebuffer is the one that
        ``context`` has bound when a list is submitted: a
        ``Renderer(device, size, to_window=True)`` draws into
        ``(0, 0, *size)`` of it, sRGB-encoded, without blending.

        The context stays the caller's. Close the device before releasing it;
        a device that is only dropped leaves its objects there. Raises
        ContextError if it is no such context.
        """
        from moka.backend.contexts.embedded import EmbeddedContext
        from moka.backend.embedded_backend import EmbeddedBackend
        from moka.graphics.calling_thread import CallingThread
        from moka.graphics.shader_source import explain_log

        guest = EmbeddedContext(context)
        device = cls(CallingThread(lambda: EmbeddedBackend(guest, explain_log)))
        # Threads that decode images ask for it.
        device._info = device.info
        return device

    def __enter__(self) -> GraphicsDevice:
        return self

    def __exit__(self, _kind: object, error: object, _: object) -> None:
        if isinstance(error, KeyboardInterrupt):
            # Whoever pressed Ctrl-C does not wait for a slow frame.
            self._finalizer.detach()
            self._thread.abandon()
        else:
            self.close()

    @property
    def info(self) -> BackendInfo:
        """Facts about the driver; waits until the context is made."""
        if self._info is None:
            self._thread.wait_until_open()
            self._info = self._thread.call(lambda backend: backend.info)
        return self._info

    @property
    def is_closed(self) -> bool:
        """Whether the device has been closed."""
        return not self._finalizer.alive

    def create_buffer(
        self, descriptor: BufferDescriptor, data: Any = None
    ) -> Handle:
        """A buffer with ``data`` (bytes-like, or an array) or undefined."""
        handle = self._handles.allocate(ResourceKind.BUFFER)
        self._thread.post(
            lambda backend: backend.create_buffer(handle, descriptor, data)
        )
        return handle

    def create_texture(
        self, descriptor: TextureDescriptor, data: TextureData | None = None
    ) -> Handle:
        """A texture; ``data`` holds one array per mip level, top row first.

        Arrays are (height, width, channels), for cube maps (6, size, size,
        channels), and must not change until they have been uploaded.
        """
        if descriptor.over is not None:
            self._handles.check(descriptor.over, ResourceKind.BUFFER)
        handle = self._handles.allocate(ResourceKind.TEXTURE)
        self._thread.post(
            lambda backend: backend.create_texture(handle, descriptor, data)
        )
        return handle

    def create_program(
        self, descriptor: ProgramDescriptor, *, wait: bool = False
    ) -> Handle:
        """A program from preprocessed shaders.

        With ``wait`` a shader that does not compile raises ShaderError here
        and the device stays usable; without, the next call raises it and
        the device is closed for work. Without, too, nobody waits for the
        driver before the next list is executed, so that it may compile
        several side by side.
        """
        if wait:
            return self.create_programs([descriptor])[0]
        handle = self._handles.allocate(ResourceKind.PROGRAM)
        self._thread.post(
            lambda backend: backend.create_program(handle, descriptor)
        )
        self._has_begun_programs = True
        return handle

    def create_programs(
        self, descriptors: Sequence[ProgramDescriptor]
    ) -> list[Handle]:
        """Several programs, which the driver may compile side by side.

        Returns when they are linked. Raises ShaderError for the first that
        does not compile or link; there is none then, and the device stays
        usable.
        """
        if not descriptors:
            return []
        handles = [
            self._handles.allocate(ResourceKind.PROGRAM) for _ in descriptors
        ]
        try:
            self._call(partial(_create_programs, handles, descriptors))
        except BaseException:
            for handle in handles:
                self._handles.release(handle)
            raise
        return handles

    def create_mesh(self, descriptor: MeshDescriptor) -> Handle:
        """A mesh over existing buffers."""
        for buffer in (descriptor.vertex_buffer, descriptor.index_buffer):
            if buffer is not None:
                self._handles.check(buffer, ResourceKind.BUFFER)
        handle = self._handles.allocate(ResourceKind.MESH)
        self._thread.post(
            lambda backend: backend.create_mesh(handle, descriptor)
        )
        return handle

    def create_framebuffer(self, descriptor: FramebufferDescriptor) -> Handle:
        """A framebuffer over existing textures."""
        for attachment in (*descriptor.colour, descriptor.depth):
            if attachment is not None:
                self._handles.check(attachment.texture, ResourceKind.TEXTURE)
        handle = self._handles.allocate(ResourceKind.FRAMEBUFFER)
        self._thread.post(
            lambda backend: backend.create_framebuffer(handle, descriptor)
        )
        return handle

    def create_bind_group(self, descriptor: BindGroupDescriptor) -> Handle:
        """Textures and uniform blocks that draws bind together."""
        for binding in descriptor.textures:
            self._handles.check(binding.texture, ResourceKind.TEXTURE)
        for block in descriptor.uniforms:
            self._handles.check(block.buffer, ResourceKind.BUFFER)
        handle = self._handles.allocate(ResourceKind.BIND_GROUP)
        self._thread.post(
            lambda backend: backend.create_bind_group(handle, descriptor)
        )
        return handle

    def destroy(self, *handles: Handle) -> None:
        """Destroy resources once the frames that use them have run.

        Raises CommandError for a handle that is not alive or not ours.
        """
        for handle in handles:
            self._handles.release(handle)
            with self._counting:
                self._releases += 1
            self._thread.post(partial(_destroy, handle))

    def count(self, kind: ResourceKind) -> int:
        """How many resources of ``kind`` are alive."""
        return self._handles.count(kind)

    def submit(
        self,
        commands: CommandList,
        *,
        sort: bool = True,
        stage: str = "frame",
        paced: bool = True,
    ) -> Frame:
        """Hand a frame over, in key order or as recorded.

        Its time counts for ``stage`` in :meth:`stage_seconds`. Waits until
        at most one other frame is in flight, unless it is not ``paced``:
        work that is done once and needs no picture before it. Raises
        CommandError for handles that are destroyed or another device's.
        """
        # Where there is a command list, this has been imported.
        from moka.commands.commands import ReadPixels

        recording = commands.finish(sort=sort)
        for handles in recording.handles:
            if self._checked.get(handles) != self._releases:
                self._check(handles)
        if paced and self._in_flight is not None:
            self._in_flight.wait_for_execution()
        frame = Frame(
            self._thread,
            self._thread.post(
                lambda backend: backend.execute(recording, stage)
            ),
            [
                step.into
                for step in recording.steps
                if isinstance(step, ReadPixels)
            ],
        )
        if paced:
            self._in_flight = frame
        return frame

    def is_ready(self, timeout: float = 0.0) -> bool:
        """Whether :meth:`submit` would not have to wait.

        Waits up to ``timeout`` seconds for that itself.
        """
        frame = self._in_flight
        return frame is None or frame.is_done_within(timeout)

    def submit_and_present(
        self, commands: CommandList, *, sort: bool = True
    ) -> Frame:
        """:meth:`submit`, then show the result in the window."""
        frame = self.submit(commands, sort=sort)
        self._thread.post(lambda backend: backend.present())
        return frame

    def read_texture(
        self, texture: Handle, *, level: int = 0, face: int = 0
    ) -> NDArray[Any]:
        """The texels of one mip level, (height, width, channels).

        Row 0 is the row at t = 0: the top row of an uploaded image, the
        bottom row of a rendered one.
        """
        self._handles.check(texture, ResourceKind.TEXTURE)
        return self._call(
            lambda backend: backend.read_texture(texture, level, face)
        )

    def stage_seconds(self) -> dict[str, float]:
        """Where the render thread's time went so far, by stage."""
        return self._call(lambda backend: backend.stage_seconds())

    def finish(self) -> None:
        """Return when the GPU has done everything submitted so far."""
        self._call(lambda backend: backend.finish())

    def close(self) -> None:
        """Free everything and end the render thread; may be called twice.

        Raises DeviceError if the thread does not end, and the error of a
        frame that failed unnoticed.
        """
        if self._finalizer.detach() is None:
            return
        if not self._thread.close():
            raise DeviceError("the render thread does not end")

    def _call(self, function: Callable[[Backend], T]) -> T:
        """What ``function`` returns, called when all else has been done.

        Programs that nobody waits for are finished by a job of its own: its
        error closes the device for work, as that of any other would.
        """
        if self._has_begun_programs:
            self._has_begun_programs = False
            self._thread.post(lambda backend: backend.finish_programs())
        return self._thread.call(function)

    def _check(self, handles: frozenset[Handle]) -> None:
        for handle in handles:
            self._handles.check(handle)
        if len(self._checked) > 256:
            self._checked.clear()
        self._checked[handles] = self._releases


def _destroy(handle: Handle, backend: Backend) -> None:
    backend.destroy(handle)


def _create_programs(
    handles: Sequence[Handle],
    descriptors: Sequence[ProgramDescriptor],
    backend: Backend,
) -> None:
    """Begin all of them, then wait; none is left where one fails."""
    begun = []
    try:
        for handle, descriptor in zip(handles, descriptors, strict=True):
            backend.create_program(handle, descriptor)
            begun.append(handle)
        backend.finish_programs(handles)
    except BaseException:
        for handle in begun:
            backend.destroy(handle)
        raise
