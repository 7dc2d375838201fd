"""Shades what is seen, and each pixel of it once: a visibility buffer.

Forward shading runs the shader for every block of pixels that a triangle
touches. On drivers in software, whose blocks are large and which shade
multisampled surfaces even where they are hidden, that is two to five times
for each pixel of a detailed model. Here a first pass notes which triangle
each sample sees (Burns and Hunt 2013, "The Visibility Buffer"), and a second
one shades that, with the same text of a shader as forward shading.
"""

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from moka.commands.command_buffer import CommandBuffer
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BlendState,
    CompareFunction,
    CullMode,
    Filter,
    FramebufferDescriptor,
    MipmapMode,
    PixelFormat,
    RasterState,
    SamplerDescriptor,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.draws import Instances
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.renderer.targets import Targets

if TYPE_CHECKING:
    from moka.renderer.prepared_scene import PreparedScene

__all__ = ["VisibilityBuffer"]

_POINTS = SamplerDescriptor(
    magnify=Filter.NEAREST, minify=Filter.NEAREST, mipmap=MipmapMode.NONE
)

# Of the depth buffer, where a full-screen pass draws at the far plane: what
# is reversed is 0 there.
_WHERE_SOMETHING_IS = RasterState(
    cull=CullMode.NONE,
    depth_test=CompareFunction.LESS,
    depth_write=False,
)
# Over what the target is cleared to: black where the environment should be
# and is not.
_OVER_THE_REST = replace(_WHERE_SOMETHING_IS, blend=BlendState.PREMULTIPLIED)
_MARK = RasterState(
    cull=CullMode.NONE, depth_test=CompareFunction.ALWAYS, colour_write=False
)
_NEAR = {"MOKA_FAR_DEPTH": "1.0"}


class VisibilityBuffer:
    """What is seen of a scene by the samples of a picture, and its shading.

    Made for ``targets``, which get the radiance of pixels; of each, as many
    ``samples`` are looked at. Their depth is there where any of these has
    something.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        targets: Targets,
        samples: int,
    ) -> None:
        self.made_for = targets, samples
        self._device = device
        self._passes = passes
        self._targets = targets
        self.samples = samples
        self._resources: list[Handle] = []
        if self._has_mask:
            self._mask_program()  # Compiles while images decode.
        self._instances: Handle | None = None
        self._instance_capacity = 0
        self._group: Handle | None = None
        self._group_of: object = None

    @property
    def _has_mask(self) -> bool:
        """Whether pixels are marked where any of their samples has something.

        The targets have one depth for each pixel: that of its one sample, or
        the mark.
        """
        return self.samples > 1

    @cached_property
    def _triangles(self) -> Handle:
        """The triangle that each sample sees."""
        return self._texture(PixelFormat.R32UI)

    @cached_property
    def _seen(self) -> Handle:
        """A framebuffer for them."""
        depth = (
            self._texture(PixelFormat.DEPTH32F)
            if self._has_mask
            else self._targets.depth_texture
        )
        return self._framebuffer((self._triangles,), depth)

    @cached_property
    def _mask(self) -> Handle:
        """A framebuffer for the marks."""
        return self._framebuffer((), self._targets.depth_texture)

    @cached_property
    def _mask_group(self) -> Handle:
        """What the program that sets them binds."""
        return self._keep(
            self._device.create_bind_group(
                BindGroupDescriptor((self._triangle_binding,))
            )
        )

    def destroy(self) -> None:
        """Free everything."""
        self._forget_group()
        if self._instances is not None:
            self._device.destroy(self._instances)
            self._instances = None
        self._device.destroy(*reversed(self._resources))
        self._resources.clear()

    def begin(
        self,
        buffer: CommandBuffer,
        area: tuple[int, int, int, int] | None,
    ) -> None:
        """Have the draws that follow note what is seen in ``area``."""
        buffer.bind_framebuffer(self._seen)
        buffer.scissor(area)
        buffer.clear((0, 0, 0, 0), 0.0)

    def shade(
        self,
        commands: CommandList,
        key: SortKey,
        prepared: "PreparedScene",
        instances: Instances,
        clear: tuple[float, float, float, float] | None,
        area: tuple[int, int, int, int] | None,
        within: tuple[int, int, int, int] | None,
    ) -> None:
        """Shade what is seen of the ``instances`` that have been drawn.

        In ``area`` the target is cleared, unless ``clear`` is None; they
        touch nothing but pixels ``within``.
        """
        buffer = commands.command_buffer(key)
        group = None
        if len(instances):
            texels = instances.view(np.uint32).reshape(-1, 4)
            group = self._bind_group(prepared, len(texels))
            assert self._instances is not None
            buffer.fill_texture(self._instances, texels)
        if self._has_mask:
            buffer.bind_framebuffer(self._mask)
            buffer.scissor(area)
            buffer.clear(None, 0.0)
            if group is not None:
                buffer.scissor(within)
                buffer.draw(
                    self._mask_program(),
                    self._passes.triangle,
                    self._mask_group,
                    _MARK,
                )
        buffer.bind_framebuffer(self._targets.scene)
        if clear is not None:
            buffer.scissor(area)
            buffer.clear(clear)
        if group is not None:
            assert prepared.visible_surface is not None
            buffer.scissor(within)
            buffer.draw(
                prepared.visible_surface.program,
                self._passes.triangle,
                group,
                _WHERE_SOMETHING_IS if clear is None else _OVER_THE_REST,
            )

    def _mask_program(self) -> Handle:
        return self._passes.program(
            "visible_pixels.frag", {**_NEAR, "MOKA_VISIBILITY": self.samples}
        )

    def _bind_group(self, prepared: "PreparedScene", texels: int) -> Handle:
        """What the surface shader binds, with room for so many texels."""
        if texels > self._instance_capacity:
            self._forget_group()
            if self._instances is not None:
                self._device.destroy(self._instances)
            # Twice as much as is needed now: instances come and go.
            self._instance_capacity = min(
                2 * texels, self._device.info.max_buffer_texels
            )
            self._instances = self._device.create_texture(
                TextureDescriptor(
                    PixelFormat.RGBA32UI,
                    self._instance_capacity,
                    1,
                    TextureKind.BUFFER,
                    label="visible instances",
                )
            )
        surface = prepared.visible_surface
        assert surface is not None
        assert self._instances is not None
        if self._group is None or self._group_of is not surface:
            self._forget_group()
            self._group_of = surface
            self._group = self._device.create_bind_group(
                BindGroupDescriptor(
                    (
                        *surface.bindings.textures,
                        self._triangle_binding,
                        TextureBinding("instances", self._instances),
                    ),
                    surface.bindings.uniforms,
                )
            )
        return self._group

    def _forget_group(self) -> None:
        if self._group is not None:
            self._device.destroy(self._group)
            self._group = None

    @property
    def _triangle_binding(self) -> TextureBinding:
        return TextureBinding("visible_triangles", self._triangles, _POINTS)

    def _texture(self, pixels: PixelFormat) -> Handle:
        return self._keep(
            self._device.create_texture(
                TextureDescriptor(
                    pixels,
                    *self._targets.size,
                    samples=self.samples,
                    label="visibility",
                )
            )
        )

    def _framebuffer(self, colour: tuple[Handle, ...], depth: Handle) -> Handle:
        return self._keep(
            self._device.create_framebuffer(
                FramebufferDescriptor(
                    tuple(map(Attachment, colour)), Attachment(depth)
                )
            )
        )

    def _keep(self, handle: Handle) -> Handle:
        self._resources.append(handle)
        return handle
