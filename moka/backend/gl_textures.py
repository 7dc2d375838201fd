"""Textures, their samplers and the framebuffers that draw into them.

Mip levels are given one by one, as the decoding threads reduced them: on a
software driver glGenerateMipmap costs ten times the upload.
"""

from ctypes import addressof, c_uint
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.protocol import TextureData
from moka.commands.descriptors import (
    Attachment,
    FramebufferDescriptor,
    MipmapMode,
    SamplerDescriptor,
    TextureDescriptor,
    TextureKind,
)
from moka.core.errors import DeviceError

__all__ = ["GlFramebuffer", "GlTexture", "SamplerCache"]

# Uploads happen on a unit that no draw uses (GL 3.3 has at least 48 in all,
# and 16 a stage), so that they never disturb what draws have bound.
SCRATCH_UNIT = 47


class GlTexture:
    """A GL texture: 2D, a cube map, or 2D of several samples."""

    def __init__(
        self,
        gl: Functions,
        descriptor: TextureDescriptor,
        data: TextureData | None,
    ) -> None:
        self._gl = gl
        self.descriptor = descriptor
        self.target = (
            c.TEXTURE_CUBE_MAP
            if descriptor.kind is TextureKind.CUBE
            else c.TEXTURE_2D_MULTISAMPLE
            if descriptor.samples > 1
            else c.TEXTURE_2D
        )
        self.name = gl.make("Textures")
        self._bind()
        if descriptor.samples > 1:
            gl.TexImage2DMultisample(
                self.target,
                descriptor.samples,
                c.pixel_format(descriptor.format)[0],
                descriptor.width,
                descriptor.height,
                True,
            )
            return
        gl.TexParameteri(self.target, c.TEXTURE_BASE_LEVEL, 0)
        gl.TexParameteri(
            self.target, c.TEXTURE_MAX_LEVEL, descriptor.level_count - 1
        )
        for level in range(descriptor.level_count):
            given = data is not None and level < len(data)
            self._define(level, data[level] if data and given else None)
        if data and len(data) < descriptor.level_count:
            gl.GenerateMipmap(self.target)

    def generate_mipmaps(self) -> None:
        """Make the lower levels from level 0, as the driver does it."""
        self._bind()
        self._gl.GenerateMipmap(self.target)

    def read(self, level: int, face: int) -> NDArray[Any]:
        """The texels of one level: (height, width, channels)."""
        descriptor = self.descriptor
        if descriptor.samples > 1:
            raise DeviceError("a multisampled texture cannot be read")
        width, height = descriptor.level_size(level)
        texels = np.empty(
            (height, width, descriptor.format.channels),
            descriptor.format.dtype,
        )
        _, layout, kind = c.pixel_format(descriptor.format)
        self._bind()
        self._gl.GetTexImage(
            self._image_target(face), level, layout, kind, texels.ctypes.data
        )
        return texels

    def release(self) -> None:
        """Delete the GL object."""
        self._gl.delete("Textures", self.name)

    def _bind(self) -> None:
        self._gl.ActiveTexture(c.TEXTURE0 + SCRATCH_UNIT)
        self._gl.BindTexture(self.target, self.name)

    def _define(self, level: int, texels: NDArray[Any] | None) -> None:
        descriptor = self.descriptor
        faces = 6 if descriptor.kind is TextureKind.CUBE else 1
        width, height = descriptor.level_size(level)
        internal, layout, kind = c.pixel_format(descriptor.format)
        images: list[NDArray[Any] | None] = [None] * faces
        if texels is not None:
            shape = descriptor.level_shape(level)
            texels = np.ascontiguousarray(texels, descriptor.format.dtype)
            if texels.size != faces * np.prod(shape):
                raise DeviceError(
                    f"texture {descriptor.label or self.name}: level {level} "
                    f"holds {texels.shape}, expected {shape}"
                )
            images = list(texels.reshape(faces, *shape))
        for face, image in enumerate(images):
            if descriptor.format.block_bytes:
                self._define_blocks(level, face, image)
                continue
            self._gl.TexImage2D(
                self._image_target(face),
                level,
                internal,
                width,
                height,
                0,
                layout,
                kind,
                None if image is None else image.ctypes.data,
            )

    def _define_blocks(
        self, level: int, face: int, blocks: NDArray[Any] | None
    ) -> None:
        descriptor = self.descriptor
        if blocks is None:
            raise DeviceError(
                f"texture {descriptor.label or self.name}: "
                f"{descriptor.format.value} needs the data of level {level}"
            )
        width, height = descriptor.level_size(level)
        self._gl.CompressedTexImage2D(
            self._image_target(face),
            level,
            c.pixel_format(descriptor.format)[0],
            width,
            height,
            0,
            blocks.nbytes,
            blocks.ctypes.data,
        )

    def _image_target(self, face: int) -> int:
        if self.target == c.TEXTURE_CUBE_MAP:
            return c.TEXTURE_CUBE_MAP_POSITIVE_X + face
        return self.target


class SamplerCache:
    """One GL sampler object per distinct descriptor.

    ``max_anisotropy`` is the driver's, 1 without the extension.
    """

    def __init__(self, gl: Functions, max_anisotropy: float) -> None:
        self._gl = gl
        self._max_anisotropy = max_anisotropy
        self._names: dict[tuple[SamplerDescriptor, bool], int] = {}

    def name(self, descriptor: SamplerDescriptor, has_levels: bool) -> int:
        """The sampler for ``descriptor``; without levels it reads none."""
        key = (descriptor, has_levels)
        if key not in self._names:
            self._names[key] = self._make(descriptor, has_levels)
        return self._names[key]

    def release(self) -> None:
        """Delete all of them."""
        for name in self._names.values():
            self._gl.delete("Samplers", name)
        self._names.clear()

    def _make(self, descriptor: SamplerDescriptor, has_levels: bool) -> int:
        gl = self._gl
        name = gl.make("Samplers")
        mipmap = descriptor.mipmap if has_levels else MipmapMode.NONE
        for parameter, value in (
            (c.TEXTURE_WRAP_S, c.WRAP[descriptor.wrap_s]),
            (c.TEXTURE_WRAP_T, c.WRAP[descriptor.wrap_t]),
            (c.TEXTURE_MAG_FILTER, c.MAGNIFY[descriptor.magnify]),
            (c.TEXTURE_MIN_FILTER, c.MINIFY[descriptor.minify, mipmap]),
        ):
            gl.SamplerParameteri(name, parameter, value)
        anisotropy = min(descriptor.anisotropy, self._max_anisotropy)
        if anisotropy > 1:
            gl.SamplerParameterf(name, c.TEXTURE_MAX_ANISOTROPY, anisotropy)
        return name


class _Attached(Struct, frozen=True):
    texture: GlTexture
    attachment: Attachment


class GlFramebuffer:
    """A framebuffer object; checked complete when it is made."""

    def __init__(
        self,
        gl: Functions,
        descriptor: FramebufferDescriptor,
        texture_of: Any,
    ) -> None:
        self._gl = gl
        self.colour_count = len(descriptor.colour)
        #: Of each colour attachment, whether it holds whole numbers.
        self.holds_integers = tuple(
            texture_of(item.texture).descriptor.format.is_integer
            for item in descriptor.colour
        )
        attached = [
            _Attached(texture_of(item.texture), item)
            for item in (*descriptor.colour, descriptor.depth)
            if item is not None
        ]
        sizes = {
            item.texture.descriptor.level_size(item.attachment.level)
            for item in attached
        }
        if len(sizes) != 1:
            raise DeviceError(
                f"framebuffer {descriptor.label}: needs attachments of one "
                f"size, got {sorted(sizes)}"
            )
        self.size = sizes.pop()
        self.has_depth = descriptor.depth is not None
        self.name = gl.make("Framebuffers")
        gl.BindFramebuffer(c.FRAMEBUFFER, self.name)
        for index, item in enumerate(attached):
            self._attach(
                c.DEPTH_ATTACHMENT
                if index == self.colour_count
                else c.COLOR_ATTACHMENT0 + index,
                item,
            )
        outputs = (c_uint * max(1, self.colour_count))(
            *(c.COLOR_ATTACHMENT0 + i for i in range(self.colour_count))
        )
        gl.DrawBuffers(max(1, self.colour_count), addressof(outputs))
        status = gl.CheckFramebufferStatus(c.FRAMEBUFFER)
        if status != c.FRAMEBUFFER_COMPLETE:
            self.release()
            formats = ", ".join(
                item.texture.descriptor.format.value for item in attached
            )
            raise DeviceError(
                f"framebuffer {descriptor.label}: the driver cannot draw "
                f"into {formats} (status {status:#x})"
            )

    def release(self) -> None:
        """Delete the GL object; its textures stay."""
        self._gl.delete("Framebuffers", self.name)

    def _attach(self, point: int, item: _Attached) -> None:
        texture = item.texture
        target = (
            c.TEXTURE_CUBE_MAP_POSITIVE_X + item.attachment.face
            if texture.target == c.TEXTURE_CUBE_MAP
            else texture.target
        )
        self._gl.FramebufferTexture2D(
            c.FRAMEBUFFER, point, target, texture.name, item.attachment.level
        )
