"""Executes the rare commands: what sets up and ends passes."""

from collections.abc import Callable
from ctypes import byref, c_float, c_uint
from typing import TYPE_CHECKING, Any

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.gl_readback import PixelReader
from moka.backend.gl_state import StateCache
from moka.backend.gl_textures import GlFramebuffer
from moka.commands.commands import (
    BindFramebuffer,
    Clear,
    Command,
    FillBuffer,
    FillTexture,
    GenerateMipmaps,
    ReadPixels,
    ResolveFramebuffer,
    SetScissor,
    SetViewport,
    Timestamp,
)
from moka.commands.handles import Handle

if TYPE_CHECKING:
    from moka.backend.gl_timestamps import TimestampQueries

__all__ = ["CommandRunner"]


class CommandRunner:
    """Runs commands and remembers which framebuffer draws go to.

    ``resource`` gives the GL object of a handle, ``reader`` reads pixels.
    ``window`` is the name of the framebuffer that stands for no handle.
    ``uploaded`` adds up bytes written, for whoever takes it and sets it to
    zero.
    """

    def __init__(
        self,
        gl: Functions,
        state: StateCache,
        resource: Callable[[Handle], Any],
        reader: PixelReader,
    ) -> None:
        self._gl = gl
        self._state = state
        self._get = resource
        self._reader = reader
        self._target: GlFramebuffer | None = None
        self._timestamps: TimestampQueries | None = None
        self.window = 0
        self.uploaded = 0

    def run(self, command: Command) -> None:
        """Execute one command."""
        match command:
            case BindFramebuffer(framebuffer):
                self._bind_framebuffer(framebuffer)
            case Clear(colour, depth):
                self._clear(colour, depth)
            case SetViewport(rectangle):
                self._state.viewport(rectangle)
            case SetScissor(rectangle):
                self._state.scissor(rectangle)
            case FillBuffer(buffer, data, offset):
                self._get(buffer).write(data, offset)
                self.uploaded += len(data)
            case FillTexture(texture, data, first):
                self._get(texture).write(data, first)
                self.uploaded += len(data)
            case GenerateMipmaps(texture):
                self._get(texture).generate_mipmaps()
            case ResolveFramebuffer(source, target):
                self._resolve(self._get(source), self._get(target))
            case ReadPixels(framebuffer):
                self._reader.read(command, self._name(framebuffer))
            case Timestamp():
                self._timestamp(command)

    def collect_times(self) -> None:
        """Hand over the times that the GPU has told; waits for none."""
        if self._timestamps is not None:
            self._timestamps.collect()

    def release(self) -> None:
        """Delete what was made to run commands."""
        if self._timestamps is not None:
            self._timestamps.release()

    def _timestamp(self, command: Timestamp) -> None:
        if self._timestamps is None:
            from moka.backend.gl_timestamps import TimestampQueries

            self._timestamps = TimestampQueries(self._gl)
        self._timestamps.record(command)

    def _name(self, handle: Handle | None) -> int:
        return self.window if handle is None else self._get(handle).name

    def _bind_framebuffer(self, handle: Handle | None) -> None:
        self._state.scissor(None)
        if handle is None:
            self._state.framebuffer(self.window)
            self._target = None
            return
        self._target = self._get(handle)
        self._state.framebuffer(self._target.name)
        self._state.viewport((0, 0, *self._target.size))

    def _clear(
        self, colour: tuple[float, ...] | None, depth: float | None
    ) -> None:
        self._state.write_masks(colour=True, depth=True)
        if colour is not None:
            target = self._target
            integers = target.holds_integers if target else (False,)
            for attachment, is_integer in enumerate(integers):
                if is_integer:
                    numbers = (c_uint * 4)(*map(int, colour))
                    self._gl.ClearBufferuiv(c.COLOR, attachment, byref(numbers))
                    continue
                values = (c_float * 4)(*colour)
                self._gl.ClearBufferfv(c.COLOR, attachment, byref(values))
        if depth is not None:
            self._gl.ClearBufferfv(c.DEPTH, 0, byref(c_float(depth)))

    def _resolve(self, source: GlFramebuffer, target: GlFramebuffer) -> None:
        gl = self._gl
        self._state.scissor(None)
        gl.BindFramebuffer(c.READ_FRAMEBUFFER, source.name)
        self._state.framebuffer(target.name)
        self._target = target
        rectangle = (0, 0, *source.size)
        gl.BlitFramebuffer(
            *rectangle, *rectangle, c.COLOR_BUFFER_BIT, c.NEAREST
        )
