"""Reads pixels back, through buffers where the GPU works beside the CPU.

Such a driver copies into a buffer when the drawing before it is done, and
this thread goes on with the next frame meanwhile. A software driver would
draw at once and copy twice, so it is asked for the pixels themselves.
"""

import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.commands.commands import ReadPixels
from moka.core.errors import DeviceError

__all__ = ["PixelReader"]

#: Longer than any frame, and yet an end.
FOREVER = 600_000_000_000  # nanoseconds


class _Reading(Struct):
    """Pixels on their way: the buffer that they go to, and its fence."""

    command: ReadPixels
    buffer: Any
    fence: Any


class PixelReader:
    """The readings of one context.

    ``new_buffer`` makes a buffer of a number of bytes; None reads without
    any. ``seconds`` adds up the time that copying takes, for whoever takes
    it and sets it to zero.
    """

    def __init__(
        self, gl: Functions, new_buffer: Callable[[int], Any] | None
    ) -> None:
        self._gl = gl
        self._new_buffer = new_buffer
        self._readings: deque[_Reading] = deque()
        self._free: dict[int, list[Any]] = {}
        self.seconds = 0.0

    def __len__(self) -> int:
        """How many have not arrived yet."""
        return len(self._readings)

    def read(self, command: ReadPixels, framebuffer: int) -> None:
        """Read now, or begin to; ``framebuffer`` is what to read from."""
        gl = self._gl
        if self._new_buffer is None:
            # Reading waits for the drawing, whose time is the frame's.
            gl.Finish()
        gl.BindFramebuffer(c.READ_FRAMEBUFFER, framebuffer)
        if command.framebuffer is not None:
            gl.ReadBuffer(c.COLOR_ATTACHMENT0 + command.attachment)
        layout, kind = c.readback_format(command.channels, command.dtype)
        area = command.rectangle
        if self._new_buffer is None:
            pixels = _pixels(command)
            start = time.perf_counter()
            gl.ReadPixels(*area, layout, kind, pixels.ctypes.data)
            self.seconds += time.perf_counter() - start
            command.into.arrived.set_result(pixels)
            return
        free = self._free.get(_size(command))
        buffer = free.pop() if free else self._new_buffer(_size(command))
        gl.BindBuffer(c.PIXEL_PACK_BUFFER, buffer.glo)
        gl.ReadPixels(*area, layout, kind, None)
        gl.BindBuffer(c.PIXEL_PACK_BUFFER, 0)
        fence = gl.FenceSync(c.SYNC_GPU_COMMANDS_COMPLETE, 0)
        self._readings.append(_Reading(command, buffer, fence))

    def take(self, most: int | None = None, timeout: int = FOREVER) -> bool:
        """Take up what has arrived; whether something is still to come.

        Of the ``most`` oldest readings, all by default, each is waited for
        up to ``timeout`` nanoseconds.
        """
        gl = self._gl
        for _ in range(len(self._readings) if most is None else most):
            reading = self._readings[0]
            state = gl.ClientWaitSync(
                reading.fence, c.SYNC_FLUSH_COMMANDS_BIT, timeout
            )
            if state == c.TIMEOUT_EXPIRED and timeout < FOREVER:
                return True
            self._readings.popleft()
            gl.DeleteSync(reading.fence)
            arrived = reading.command.into.arrived
            if state not in (c.ALREADY_SIGNALED, c.CONDITION_SATISFIED):
                reading.buffer.release()
                arrived.set_exception(
                    DeviceError("reading back: the GPU has not answered")
                )
                continue
            arrived.set_result(self._copy(reading))
        return bool(self._readings)

    def release(self) -> None:
        """Give up what has not arrived, and free the buffers."""
        for reading in self._readings:
            self._gl.DeleteSync(reading.fence)
            reading.buffer.release()
            reading.command.into.arrived.set_exception(
                DeviceError("the graphics device is closed")
            )
        self._readings.clear()
        for buffers in self._free.values():
            for buffer in buffers:
                buffer.release()
        self._free.clear()

    def _copy(self, reading: _Reading) -> NDArray[Any]:
        """The pixels; their buffer is free for the next reading."""
        gl = self._gl
        pixels = _pixels(reading.command)
        start = time.perf_counter()
        gl.BindBuffer(c.PIXEL_PACK_BUFFER, reading.buffer.glo)
        gl.GetBufferSubData(
            c.PIXEL_PACK_BUFFER, 0, pixels.nbytes, pixels.ctypes.data
        )
        gl.BindBuffer(c.PIXEL_PACK_BUFFER, 0)
        self.seconds += time.perf_counter() - start
        # Of other sizes there will hardly be another one.
        for size in [size for size in self._free if size != pixels.nbytes]:
            for buffer in self._free.pop(size):
                buffer.release()
        self._free.setdefault(pixels.nbytes, []).append(reading.buffer)
        return pixels


def _pixels(command: ReadPixels) -> NDArray[Any]:
    _, _, width, height = command.rectangle
    return np.empty((height, width, command.channels), command.dtype)


def _size(command: ReadPixels) -> int:
    _, _, width, height = command.rectangle
    texel = command.channels * np.dtype(command.dtype).itemsize
    return width * height * texel
