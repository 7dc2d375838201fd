"""Draws panels through moka's own command list.

What Dear ImGui wants drawn becomes buffers and packets like everything else,
so that the render thread stays the only one that speaks OpenGL.
"""

from typing import Any

import numpy as np

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BlendState,
    BufferDescriptor,
    BufferUsage,
    CullMode,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    RasterState,
    SamplerDescriptor,
    TextureBinding,
    TextureDescriptor,
    Topology,
    UniformBinding,
    VertexAttribute,
    VertexLayout,
    Wrap,
)
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.graphics.shader_source import load_shader
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.ui.draw_data import VERTEX, Batch, Geometry, flatten

__all__ = ["InterfacePass"]

_BLOCK = UniformLayout("Interface", (Parameter("window", ParameterType.VEC4),))

_STATE = RasterState(
    cull=CullMode.NONE,
    depth_test=None,
    depth_write=False,
    blend=BlendState.ALPHA,
)

_SAMPLER = SamplerDescriptor(Wrap.CLAMP_TO_EDGE, Wrap.CLAMP_TO_EDGE)

_LAYOUT = VertexLayout(
    (
        VertexAttribute("position", "f4", 2, 0),
        VertexAttribute("uv", "f4", 2, 8),
        VertexAttribute("colour", "u1", 4, 16, normalised=True),
        VertexAttribute("clip", "f4", 4, 20),
    ),
    VERTEX.itemsize,
)

_SMALLEST_BUFFER = 1 << 16


class _GrowingBuffer:
    """A buffer that is replaced by one of twice its size when it is full."""

    def __init__(self, device: GraphicsDevice, usage: BufferUsage) -> None:
        self._device = device
        self._usage = usage
        self._size = 0
        self.handle: Handle

    def reserve(self, size: int) -> bool:
        """Make room for ``size`` bytes; whether the buffer is another."""
        if size <= self._size:
            return False
        if self._size:
            self._device.destroy(self.handle)
        self._size = max(_SMALLEST_BUFFER, 1 << (size - 1).bit_length())
        self.handle = self._device.create_buffer(
            BufferDescriptor(
                self._usage, self._size, dynamic=True, label="interface"
            )
        )
        return True


class InterfacePass:
    """The panels of one Dear ImGui context on one device."""

    def __init__(self, device: GraphicsDevice) -> None:
        self._device = device
        self._vertices = _GrowingBuffer(device, BufferUsage.VERTEX)
        self._indices = _GrowingBuffer(device, BufferUsage.INDEX)
        self._meshes: dict[Batch, Handle] = {}
        self._textures: dict[int, tuple[Handle, Handle]] = {}
        self._program = device.create_program(
            ProgramDescriptor(
                load_shader("interface.vert"),
                load_shader("interface.frag"),
                "interface",
            )
        )
        self._block = device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM, _BLOCK.size, dynamic=True, label="window"
            ),
            np.zeros(_BLOCK.size, np.uint8),
        )

    def draw(
        self,
        draw_data: Any,
        commands: CommandList,
        key: SortKey,
        framebuffer: Handle | None,
        size: tuple[int, int],
    ) -> int:
        """Record an ``ImDrawData`` over what ``framebuffer`` shows.

        ``size`` is the framebuffer's in pixels; None is the window. Returns
        how many draws that takes.
        """
        for texture in draw_data.textures or ():
            self._update_texture(texture)
        geometry = flatten(draw_data)
        if not geometry.batches:
            return 0
        corner, extent = draw_data.display_pos, draw_data.display_size
        buffer = commands.command_buffer(key)
        self._update_meshes(geometry)
        buffer.fill_buffer(self._vertices.handle, geometry.vertices)
        buffer.fill_buffer(self._indices.handle, geometry.indices)
        buffer.fill_buffer(
            self._block,
            _BLOCK.pack({"window": (corner.x, corner.y, extent.x, extent.y)}),
        )
        buffer.bind_framebuffer(framebuffer)
        buffer.viewport(0, 0, *size)
        for batch in geometry.batches:
            _, group = self._textures[batch.texture]
            buffer.draw(self._program, self._meshes[batch], group, _STATE)
        return len(geometry.batches)

    def _update_meshes(self, geometry: Geometry) -> None:
        grown = self._vertices.reserve(geometry.vertices.nbytes)
        grown |= self._indices.reserve(geometry.indices.nbytes)
        wanted = set(geometry.batches)
        for batch in list(self._meshes):
            if grown or batch not in wanted:
                self._device.destroy(self._meshes.pop(batch))
        for batch in wanted - self._meshes.keys():
            self._meshes[batch] = self._device.create_mesh(
                MeshDescriptor(
                    Topology.TRIANGLES,
                    batch.count,
                    first=batch.first,
                    vertex_buffer=self._vertices.handle,
                    layout=_LAYOUT,
                    index_buffer=self._indices.handle,
                )
            )

    def _update_texture(self, texture: Any) -> None:
        """Do what Dear ImGui asks for: make, replace or destroy a texture."""
        from imgui_bundle import imgui

        status = imgui.ImTextureStatus
        if texture.status in (status.ok, status.destroyed):
            return
        number = texture.unique_id + 1  # 0 is no texture.
        old = self._textures.pop(number, None)
        if old is not None:
            self._device.destroy(*reversed(old))
        if texture.status == status.want_destroy:
            texture.set_tex_id(0)
            texture.set_status(status.destroyed)
            return
        self._textures[number] = self._upload(
            texture.get_pixels_array().reshape(
                texture.height, texture.width, texture.bytes_per_pixel
            )
        )
        texture.set_tex_id(number)
        texture.set_status(status.ok)

    def _upload(self, pixels: Any) -> tuple[Handle, Handle]:
        """A texture and the bind group that has it."""
        height, width, _ = pixels.shape
        texture = self._device.create_texture(
            TextureDescriptor(PixelFormat.RGBA8, width, height, label="glyphs"),
            [pixels.copy()],  # Dear ImGui may draw into it meanwhile.
        )
        group = self._device.create_bind_group(
            BindGroupDescriptor(
                (TextureBinding("glyphs", texture, _SAMPLER),),
                (UniformBinding("Interface", self._block),),
            )
        )
        return texture, group
