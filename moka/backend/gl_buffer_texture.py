"""Textures that are one long row of texels, read by their numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.gl_textures import SCRATCH_UNIT
from moka.backend.protocol import TextureData
from moka.commands.descriptors import TextureDescriptor

__all__ = ["GlBufferTexture"]


class GlBufferTexture:
    """A GL texture over a buffer, ``width`` texels long.

    What :class:`moka.backend.gl_textures.GlTexture` is to other kinds. The
    buffer is the GL object ``over``, or its own.
    """

    target = c.TEXTURE_BUFFER

    def __init__(
        self,
        gl: Functions,
        descriptor: TextureDescriptor,
        data: TextureData | None,
        over: int | None = None,
    ) -> None:
        self._gl = gl
        self.descriptor = descriptor
        channels, dtype = descriptor.format.channels, descriptor.format.dtype
        self._texel = channels * np.dtype(dtype).itemsize
        self.name = gl.make("Textures")
        self._owns_buffer = over is None
        self._buffer = self._make_buffer(data) if over is None else over
        gl.ActiveTexture(c.TEXTURE0 + SCRATCH_UNIT)
        gl.BindTexture(self.target, self.name)
        internal, _, _ = c.pixel_format(descriptor.format)
        gl.TexBuffer(self.target, internal, self._buffer)

    def _make_buffer(self, data: TextureData | None) -> int:
        gl, descriptor = self._gl, self.descriptor
        texels = None
        if data:
            dtype = descriptor.format.dtype
            texels = np.ascontiguousarray(data[0], dtype)
        name = gl.make("Buffers")
        gl.BindBuffer(c.TEXTURE_BUFFER, name)
        gl.BufferData(
            c.TEXTURE_BUFFER,
            descriptor.width * self._texel,
            None if texels is None else texels.ctypes.data,
            c.DYNAMIC_DRAW,
        )
        return name

    def write(self, data: bytes, first: int) -> None:
        """Replace the texels from number ``first`` on."""
        self._gl.BindBuffer(c.TEXTURE_BUFFER, self._buffer)
        self._gl.BufferSubData(
            c.TEXTURE_BUFFER, first * self._texel, len(data), data
        )

    def read(self, _level: int, _face: int) -> NDArray[Any]:
        """The texels: (1, width, channels)."""
        descriptor = self.descriptor
        channels, dtype = descriptor.format.channels, descriptor.format.dtype
        texels = np.empty((1, descriptor.width, channels), dtype)
        self._gl.BindBuffer(c.TEXTURE_BUFFER, self._buffer)
        self._gl.GetBufferSubData(
            c.TEXTURE_BUFFER, 0, texels.nbytes, texels.ctypes.data
        )
        return texels

    def release(self) -> None:
        """Delete the GL objects."""
        self._gl.delete("Textures", self.name)
        if self._owns_buffer:
            self._gl.delete("Buffers", self._buffer)
