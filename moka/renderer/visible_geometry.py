"""Vertices and indices as textures, for shaders that know what is seen.

A visibility buffer says which triangle a sample shows; a shader then looks
its corners up in the buffers that the triangles are drawn from.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    IndexType,
    PixelFormat,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.draws import INSTANCE
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.renderer.geometry import JoinedMeshes, vertex_layout

__all__ = [
    "INSTANCE_TEXELS",
    "VisibleGeometry",
    "vertex_texels",
    "visible_defines",
]

#: Texels of four whole numbers that a row of INSTANCE has.
INSTANCE_TEXELS = INSTANCE.itemsize // 16

# The widest texels first: each takes one read.
_TEXELS = {
    4: PixelFormat.RGBA32F,
    2: PixelFormat.RG32F,
    1: PixelFormat.R32F,
}


def visible_defines(attributes: Sequence[str]) -> dict[str, str | int]:
    """How include/visible_triangle.glsl finds these glTF attributes."""
    layout = vertex_layout(attributes)
    defines: dict[str, str | int] = {
        "MOKA_TEXEL_WIDTH": _texel_width(layout.stride),
        "MOKA_VERTEX_TEXELS": vertex_texels(attributes),
    }
    for attribute in layout.attributes:
        if attribute.offset:
            name = f"MOKA_{attribute.name.upper()}_AT"
            defines[name] = attribute.offset // 4
    return defines


def vertex_texels(attributes: Sequence[str]) -> int:
    """How many texels a vertex with these glTF attributes has."""
    stride = vertex_layout(attributes).stride
    return stride // (4 * _texel_width(stride))


class VisibleGeometry:
    """The buffers of ``meshes`` as textures.

    ``first`` and ``base_vertex`` (P,) are where the indices of each mesh
    begin and what is added to them, ``triangle_bits`` as many as count the
    triangles of the largest from 1.
    """

    def __init__(self, device: GraphicsDevice, meshes: JoinedMeshes) -> None:
        self._device = device
        members = meshes.members
        self.first: NDArray[np.uint32] = np.array(
            [mesh.first for mesh in members], np.uint32
        )
        self.base_vertex: NDArray[np.uint32] = np.array(
            [mesh.base_vertex for mesh in members], np.uint32
        )
        self.triangle_bits = max(
            mesh.count // 3 for mesh in members
        ).bit_length()
        its = members[0]
        assert its.layout is not None
        width = _texel_width(its.layout.stride)
        indices = (
            PixelFormat.R16UI
            if its.index_type is IndexType.UINT16
            else PixelFormat.R32UI
        )
        self._textures = {
            "vertices": self._texture(
                _TEXELS[width],
                meshes.vertices * its.layout.stride // (4 * width),
                its.vertex_buffer,
            ),
            "indices": self._texture(indices, meshes.indices, its.index_buffer),
        }

    @property
    def bindings(self) -> tuple[TextureBinding, ...]:
        """The textures as the shader names them."""
        return tuple(
            TextureBinding(name, texture)
            for name, texture in self._textures.items()
        )

    def destroy(self) -> None:
        """Free the textures; buffers stay."""
        self._device.destroy(*self._textures.values())

    def _texture(
        self, pixels: PixelFormat, texels: int, buffer: Handle | None
    ) -> Handle:
        return self._device.create_texture(
            TextureDescriptor(
                pixels,
                texels,
                1,
                TextureKind.BUFFER,
                label="visible geometry",
                over=buffer,
            )
        )


def _texel_width(stride: int) -> int:
    """How many floats are read at once of vertices of ``stride`` bytes."""
    return next(width for width in _TEXELS if stride % (4 * width) == 0)
