"""The passes over the whole picture: what is behind, and the display."""

import numpy as np

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BlendState,
    BufferDescriptor,
    BufferUsage,
    CompareFunction,
    CullMode,
    RasterState,
    TextureBinding,
    UniformBinding,
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
from moka.lighting.preintegration import CUBE_SAMPLER, MAP_SAMPLER
from moka.renderer.targets import Targets
from moka.renderer.view import View

__all__ = ["ScreenPasses"]

_BACKGROUND = UniformLayout(
    "Background",
    (
        Parameter("direction_from_clip", ParameterType.MAT4),
        Parameter("parameters", ParameterType.VEC4),
    ),
)
_TONE_MAP = UniformLayout(
    "ToneMap",
    (
        Parameter("parameters", ParameterType.VEC4),
        Parameter("background", ParameterType.VEC4),
    ),
)


class ScreenPasses:
    """Draws the environment behind the scene, and the display from it."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._groups: dict[BindGroupDescriptor, Handle] = {}
        self._background = self._buffer(_BACKGROUND)
        self._tone_map = self._buffer(_TONE_MAP)

    def forget(self) -> None:
        """Destroy what refers to textures that are about to go."""
        self._device.destroy(*self._groups.values())
        self._groups.clear()

    def draw_background(
        self,
        commands: CommandList,
        key: SortKey,
        targets: Targets,
        environment_map: Handle,
        view: View,
        *,
        rotation: float,
        intensity: float,
        float_target: bool,
    ) -> None:
        """Draw the map wherever nothing is nearer.

        ``rotation`` is the environment's, in radians about +Y. With
        multisampling this comes after the resolve, under what is there: the
        sky has no edges, and one sample a pixel costs half of a whole frame
        less than four. (Coverage composites in any order; Porter and Duff
        1984.)
        """
        is_reversed = self._device.info.clip_control
        defines: dict[str, str | int] = {
            "MOKA_FAR_DEPTH": "0.0" if is_reversed else "1.0"
        }
        if float_target:
            defines["MOKA_FLOAT_TARGET"] = 1
        values = _BACKGROUND.pack(
            {
                "direction_from_clip": view.direction_from_clip(rotation),
                "parameters": (intensity, 0.0, 0.0, 0.0),
            }
        )
        group = BindGroupDescriptor(
            (TextureBinding("environment_map", environment_map, MAP_SAMPLER),),
            (UniformBinding("Background", self._background),),
        )
        nearer = (
            CompareFunction.GREATER_EQUAL
            if is_reversed
            else CompareFunction.LESS_EQUAL
        )
        buffer = commands.command_buffer(key)
        if targets.is_multisampled:
            state = RasterState(
                cull=CullMode.NONE,
                depth_test=None,
                depth_write=False,
                blend=BlendState.UNDER,
            )
            buffer.bind_framebuffer(targets.resolved)
        else:
            state = RasterState(
                cull=CullMode.NONE, depth_test=nearer, depth_write=False
            )
        buffer.fill_buffer(self._background, values)
        buffer.draw(
            self._passes.program("background.frag", defines),
            self._passes.triangle,
            self._group(group),
            state,
        )

    def resolve(
        self, commands: CommandList, key: SortKey, targets: Targets
    ) -> None:
        """Average the samples of the scene, if it has several."""
        if targets.is_multisampled:
            commands.resolve(targets.scene, targets.resolved, key=key)

    def draw_display(
        self,
        commands: CommandList,
        key: SortKey,
        targets: Targets,
        *,
        tone_map: str,
        exposure: float,
        background: tuple[float, float, float] | None,
        window: tuple[int, int] | None,
    ) -> None:
        """Expose, tone map and encode.

        ``background`` is a linear display colour that shows through where
        coverage is below 1; None keeps alpha. ``window`` is the size of the
        window to draw into instead of the display target.
        """
        values = _TONE_MAP.pack(
            {
                "parameters": (2.0**exposure, 1.0, 0.0, 0.0),
                "background": (
                    (0, 0, 0, 0) if background is None else (*background, 1)
                ),
            }
        )
        group = BindGroupDescriptor(
            (
                TextureBinding(
                    "radiance_map", targets.resolved_texture, CUBE_SAMPLER
                ),
            ),
            (UniformBinding("ToneMap", self._tone_map),),
        )
        buffer = commands.command_buffer(key)
        buffer.fill_buffer(self._tone_map, values)
        if window is None:
            buffer.bind_framebuffer(targets.display)
        else:
            buffer.bind_framebuffer(None)
            buffer.viewport(0, 0, *window)
        buffer.draw(
            self._passes.program(
                "tone_map.frag", {f"MOKA_TONE_MAP_{tone_map.upper()}": 1}
            ),
            self._passes.triangle,
            self._group(group),
            FULLSCREEN,
        )

    def _group(self, descriptor: BindGroupDescriptor) -> Handle:
        if descriptor not in self._groups:
            group = self._device.create_bind_group(descriptor)
            self._groups[descriptor] = group
        return self._groups[descriptor]

    def _buffer(self, layout: UniformLayout) -> Handle:
        return self._device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM,
                layout.size,
                dynamic=True,
                label=layout.name,
            ),
            np.zeros(layout.size, np.uint8),
        )
