"""Shows one value of the surfaces in the place of their light."""

from types import MappingProxyType

import numpy as np
from msgspec import Struct

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    Filter,
    MipmapMode,
    SamplerDescriptor,
    TextureBinding,
    UniformBinding,
    Wrap,
)
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FULLSCREEN, FullscreenPasses
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.renderer.surface_values import OBJECTS, ValueTargets, group_of

__all__ = ["DEBUG_VIEWS", "DebugPass", "DebugView"]


class DebugView(Struct, frozen=True):
    """Which value is shown, and the shader's name of how."""

    value: str
    how: str


#: By the name that a person reads.
DEBUG_VIEWS = MappingProxyType(
    {
        "base colour": DebugView("albedo", "BASE_COLOUR"),
        "roughness": DebugView("roughness", "W"),
        "metalness": DebugView("metallic", "W"),
        "normal": DebugView("normal", "DIRECTION"),
        "tangent": DebugView("tangent", "DIRECTION"),
        "texture coordinates": DebugView("uv", "UV"),
        "occlusion": DebugView("occlusion", "Z"),
        "emission": DebugView("emission", "EMISSION"),
        "Fresnel": DebugView("fresnel", "BASE_COLOUR"),
        "overdraw": DebugView("overdraw", "COUNT"),
        "depth": DebugView("depth", "DEPTH"),
        "objects": DebugView("object-id", "OBJECT"),
        "mip level": DebugView("mip-level", "LEVEL"),
    }
)

_BLOCK = UniformLayout("DebugView", (Parameter("view", ParameterType.VEC4),))

_TEXELS = SamplerDescriptor(
    Wrap.CLAMP_TO_EDGE,
    Wrap.CLAMP_TO_EDGE,
    Filter.NEAREST,
    Filter.NEAREST,
    MipmapMode.NEAREST,
)


class DebugPass:
    """Draws value targets as colours."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._block = device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM, _BLOCK.size, dynamic=True, label="debug"
            ),
            np.zeros(_BLOCK.size, np.uint8),
        )
        self._group: Handle | None = None
        self._made_for: object = None

    def draw(
        self,
        view: DebugView,
        targets: ValueTargets,
        distance: float,
        commands: CommandList,
        key: SortKey,
        framebuffer: Handle | None,
        size: tuple[int, int],
    ) -> None:
        """Record it over the lower left ``size`` of ``framebuffer``.

        ``distance`` in metres is middle grey where depth is shown.
        """
        buffer = commands.command_buffer(key)
        buffer.fill_buffer(
            self._block, _BLOCK.pack({"view": (distance, 0, 0, 0)})
        )
        buffer.bind_framebuffer(framebuffer)
        buffer.viewport(0, 0, *size)
        buffer.draw(
            self._passes.program(
                "debug_view.frag", {f"MOKA_VIEW_{view.how}": 1}
            ),
            self._passes.triangle,
            self._bound(view, targets),
            FULLSCREEN,
        )

    def _bound(self, view: DebugView, targets: ValueTargets) -> Handle:
        shown = targets.textures[group_of(view.value)]
        objects = targets.textures[OBJECTS]
        if self._group is None or self._made_for != (shown, objects):
            if self._group is not None:
                self._device.destroy(self._group)
            self._made_for = shown, objects
            self._group = self._device.create_bind_group(
                BindGroupDescriptor(
                    (
                        TextureBinding("values", shown, _TEXELS),
                        TextureBinding("objects", objects, _TEXELS),
                    ),
                    (UniformBinding("DebugView", self._block),),
                )
            )
        return self._group
