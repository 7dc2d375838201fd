"""The passes over the whole picture: what is behind, and the display."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from moka.commands.command_buffer import CommandBuffer
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
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
from moka.lighting.environment_maps import CUBE_SAMPLER
from moka.renderer.sky import MOST_DISCS, Sky, background_layout
from moka.renderer.targets import Targets

__all__ = ["ScreenPart", "ScreenPasses"]

_TONE_MAP = UniformLayout(
    "ToneMap",
    (
        Parameter("display_parameters", ParameterType.VEC4),
        Parameter("background_colour", ParameterType.VEC4),
    ),
)

# Of a depth buffer that is reversed, by a triangle at its far plane, 0.
_WHERE_NOTHING_IS = replace(
    FULLSCREEN, depth_test=CompareFunction.GREATER_EQUAL
)
_WHERE_SOMETHING_IS = replace(FULLSCREEN, depth_test=CompareFunction.LESS)


class ScreenPart(Struct, frozen=True):
    """The pixels of a picture that ``state`` lets through.

    They show the scene, the sky, or one behind the other.
    """

    program: Handle
    state: RasterState
    has_scene: bool
    has_sky: bool


class ScreenPasses:
    """Draws the environment behind the scene, and the display from it."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._groups: dict[BindGroupDescriptor, Handle] = {}
        self._background = self._buffer(background_layout(MOST_DISCS))
        self._sky_block = UniformBinding("Background", self._background)
        self._tone_map = self._buffer(_TONE_MAP)

    def forget(self) -> None:
        """Destroy what refers to textures that are about to go."""
        self._device.destroy(*self._groups.values())
        self._groups.clear()

    def draw_background(
        self, commands: CommandList, key: SortKey, sky: Sky
    ) -> None:
        """Draw the sky wherever nothing is nearer."""
        is_reversed = self._device.info.clip_control
        state = RasterState(
            cull=CullMode.NONE,
            depth_test=(
                CompareFunction.GREATER_EQUAL
                if is_reversed
                else CompareFunction.LESS_EQUAL
            ),
            depth_write=False,
        )
        far = {"MOKA_FAR_DEPTH": "0.0" if is_reversed else "1.0"}
        buffer = commands.command_buffer(key)
        buffer.fill_buffer(self._background, sky.block)
        buffer.draw(
            self._program("background.frag", {**sky.defines, **far}),
            self._passes.triangle,
            self._group(
                BindGroupDescriptor((sky.binding,), (self._sky_block,))
            ),
            state,
        )

    def resolve(
        self,
        buffer: CommandBuffer,
        targets: Targets,
        sky: Sky | None,
        marked: int,
    ) -> None:
        """Write one radiance a pixel into ``targets.resolved``.

        ``sky`` is what lies behind the scene and has not been drawn there,
        ``marked`` as in :meth:`display_parts`.
        """
        parts = self._parts("resolve.frag", {}, targets, sky, marked)
        buffer.bind_framebuffer(
            targets.marked_resolved if len(parts) > 1 else targets.resolved
        )
        self._draw(buffer, parts, targets, sky)

    def display_parts(
        self,
        targets: Targets,
        sky: Sky | None,
        marked: int,
        *,
        tone_map: str,
        has_gamma: bool,
        has_background: bool,
    ) -> tuple[ScreenPart, ...]:
        """What :meth:`draw_display` draws; ``sky`` is as there.

        Apart from it, to be compiled while something else is waited for.
        Where ``marked`` is not 0, the depth of the targets says in which
        pixels any of so many samples has something, which is opaque. Then
        the others show the sky alone, whatever the targets hold.
        """
        defines: dict[str, str | int] = {"MOKA_DISPLAY": 1}
        defines[f"MOKA_TONE_MAP_{tone_map.upper()}"] = 1
        if has_background:
            defines["MOKA_BACKGROUND_COLOUR"] = 1
        if has_gamma:
            defines["MOKA_ENCODE_GAMMA"] = 1
        return self._parts("tone_map.frag", defines, targets, sky, marked)

    def draw_display(
        self,
        commands: CommandList,
        key: SortKey,
        parts: Sequence[ScreenPart],
        targets: Targets,
        sky: Sky | None,
        *,
        exposure: float,
        gamma: float | None,
        background: tuple[float, float, float] | None,
        window: tuple[int, int] | None,
        area: tuple[int, int, int, int] | None = None,
    ) -> None:
        """Average the samples, expose, tone map and encode by ``parts``.

        ``gamma`` encodes by a power, None as sRGB.

        ``sky`` is as in :meth:`resolve`. ``background`` is a linear display
        colour that shows through where coverage is below 1; None keeps
        alpha. ``window`` is the size of the window to draw into instead of
        the display target; nothing is written outside of ``area``.
        """
        values = _TONE_MAP.pack(
            {
                "display_parameters": (2.0**exposure, 1 / (gamma or 1), 0, 0),
                "background_colour": (*(background or (0, 0, 0)), 0),
            }
        )
        buffer = commands.command_buffer(key)
        buffer.fill_buffer(self._tone_map, values)
        if window is not None:
            buffer.bind_framebuffer(None)
            buffer.viewport(0, 0, *window)
        else:
            buffer.bind_framebuffer(
                targets.marked_display if len(parts) > 1 else targets.display
            )
        buffer.scissor(area)
        block = UniformBinding("ToneMap", self._tone_map)
        self._draw(buffer, parts, targets, sky, block)

    def _parts(
        self,
        fragment: str,
        defines: dict[str, str | int],
        targets: Targets,
        sky: Sky | None,
        marked: int,
    ) -> tuple[ScreenPart, ...]:
        def part(
            state: RasterState, scene: Targets | None, sky: Sky | None
        ) -> ScreenPart:
            return ScreenPart(
                self._program(fragment, defines | _scene_defines(scene, sky)),
                state,
                has_scene=scene is not None,
                has_sky=sky is not None,
            )

        if not marked or sky is None:
            return (part(FULLSCREEN, targets, sky),)
        return (
            part(_WHERE_NOTHING_IS, None, sky),
            # One sample covers all of its pixel.
            part(_WHERE_SOMETHING_IS, targets, sky if marked > 1 else None),
        )

    def _draw(
        self,
        buffer: CommandBuffer,
        parts: Sequence[ScreenPart],
        targets: Targets,
        sky: Sky | None,
        *blocks: UniformBinding,
    ) -> None:
        if sky is not None:
            buffer.fill_buffer(self._background, sky.block)
        for part in parts:
            textures = _textures(
                targets if part.has_scene else None,
                sky if part.has_sky else None,
            )
            buffer.draw(
                part.program,
                self._passes.triangle,
                self._group(
                    BindGroupDescriptor(textures, (self._sky_block, *blocks))
                ),
                part.state,
            )

    def _program(self, fragment: str, defines: dict[str, str | int]) -> Handle:
        return self._passes.program(fragment, defines, vertex="screen.vert")

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


def _scene_defines(
    scene: Targets | None, sky: Sky | None
) -> dict[str, str | int]:
    """The defines of scene_radiance.glsl."""
    defines: dict[str, str | int] = {}
    if scene is None:
        defines["MOKA_SKY_ALONE"] = 1
    elif scene.samples > 1:
        defines["MOKA_SAMPLES"] = scene.samples
    if sky is not None:
        defines |= sky.defines
    return defines


def _textures(
    scene: Targets | None, sky: Sky | None
) -> tuple[TextureBinding, ...]:
    """The textures that scene_radiance.glsl reads."""
    textures = []
    if scene is not None:
        textures.append(
            TextureBinding("radiance_map", scene.scene_texture, CUBE_SAMPLER)
        )
    if sky is not None:
        textures.append(sky.binding)
    return tuple(textures)
