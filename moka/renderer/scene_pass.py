"""The scene pass: a scene's surfaces become radiance.

As they are drawn, or each pixel once when a visibility buffer has what it
sees.
"""

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_buffer import CommandBuffer
from moka.commands.command_list import CommandList
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.core.maths import Array
from moka.graphics.device import GraphicsDevice
from moka.renderer.frame_block import frame_values
from moka.renderer.frame_order import LAYER_BACKGROUND, PASS_SCENE
from moka.renderer.frame_scene import FrameScene
from moka.renderer.frame_targets import FrameTargets
from moka.renderer.geometry import GeometryPool
from moka.renderer.light_sources import LightSources, light_capacity
from moka.renderer.progressive import Progressive
from moka.renderer.scene_preparation import ScenePreparation
from moka.renderer.settings import RenderSettings

__all__ = ["ScenePass"]

# x, y, width, height in pixels from the lower left.
Rectangle = tuple[int, int, int, int]


class ScenePass:
    """Records it for one renderer.

    ``frame`` is the uniform buffer of the block ``Frame``.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        frame: Handle,
        sources: LightSources,
        geometry: GeometryPool,
        preparation: ScenePreparation,
        targets: FrameTargets,
        progressive: Progressive,
    ) -> None:
        self._is_reversed = device.info.clip_control
        self._frame = frame
        self._sources = sources
        self._geometry = geometry
        self._preparation = preparation
        self._targets = targets
        self._progressive = progressive
        # What the world box was computed of.
        self._box_of: tuple[object, ...] = ()
        self._box: Array | None = None

    def draw(
        self,
        seen: FrameScene,
        settings: RenderSettings,
        size: tuple[int, int],
        lights: NDArray[np.void],
        area: Rectangle | None,
        commands: CommandList,
        *,
        clears: bool,
    ) -> None:
        """Draw what is ``seen`` and prepared into the current targets.

        ``lights`` are the rows of what shines. Only ``area``, or the tiles
        that reference lighting is still at, gets anything. Unless it
        ``clears``, radiance is left as it was where the depth that a
        visibility buffer leaves says that nothing is.
        """
        preparation, scene = self._preparation, seen.scene
        prepared = preparation.prepared
        visibility = self._targets.visibility
        if seen.poses is not None:
            seen.poses.update(seen.visible, self._geometry, commands)
        setup = commands.command_buffer(SortKey(PASS_SCENE))
        self._fill_blocks(seen, settings, size, lights, setup)
        # Black is opaque where the environment should be and is not.
        is_dark = (
            scene.background == "environment" and self._sources.maps.map is None
        )
        clear = (0.0, 0.0, 0.0, float(is_dark))
        if visibility is not None:
            visibility.begin(setup, area)
        else:
            setup.bind_framebuffer(self._targets.current.scene)
            setup.clear(clear, 0.0 if self._is_reversed else 1.0)
            if settings.accumulates:
                self._progressive.mask(setup, 1.0 if self._is_reversed else 0.0)
            elif area is not None:
                setup.scissor(area)
        states = np.array(
            [commands.state_index(state) for state in prepared.states],
            np.uint32,
        )
        commands.use(prepared.handles)
        draws, instances = preparation.gatherer.gather(
            scene.transforms, seen.visible, seen.view, states
        )
        commands.draws(draws, instances, in_order=True)
        if visibility is not None:
            visibility.shade(
                commands,
                SortKey(PASS_SCENE, LAYER_BACKGROUND),
                prepared,
                instances,
                clear if clears else None,
                area,
                self._reach(seen, size, area),
            )

    def _reach(
        self, seen: FrameScene, size: tuple[int, int], area: Rectangle | None
    ) -> Rectangle | None:
        """The part of ``area`` that surfaces can touch, None for all of it."""
        scene = seen.scene
        key = (
            scene.drawables,
            scene.transforms.version,
            scene.pose_version,
            scene.visibility_version,
        )
        if self._box_of != key:
            self._box_of = key
            self._box = scene.bounds()
        if self._box is None:
            return area
        reach = seen.view.rectangle_of(self._box, size)
        return area if reach is None else _common(reach, area)

    def _fill_blocks(
        self,
        seen: FrameScene,
        settings: RenderSettings,
        size: tuple[int, int],
        lights: NDArray[np.void],
        setup: CommandBuffer,
    ) -> None:
        """Write what all surfaces read: the frame, materials and lights."""
        prepared = self._preparation.prepared
        samples = (0, settings.ibl_samples, 0, 0)
        if settings.accumulates:
            samples = self._progressive.sample_range
        surface = prepared.visible_surface
        setup.fill_buffer(
            self._frame,
            frame_values(
                seen.scene,
                seen.view,
                size,
                harmonics=self._sources.harmonics,
                specular_levels=self._sources.maps.specular_levels,
                light_count=len(lights),
                sample_range=samples,
                triangle_bits=0 if surface is None else surface.triangle_bits,
            ),
        )
        live = seen.scene.live_materials
        if live is not None:
            prepared.update_materials(live, setup)
        capacity = light_capacity(len(lights)) if prepared.is_lit else 0
        if capacity:
            setup.fill_buffer(
                self._sources.buffer(capacity), lights.view(np.uint8)
            )


def _common(first: Rectangle, second: Rectangle | None) -> Rectangle:
    """What two rectangles have in common; nothing has no width or height."""
    if second is None:
        return first
    left, bottom = max(first[0], second[0]), max(first[1], second[1])
    right = min(first[0] + first[2], second[0] + second[2])
    top = min(first[1] + first[3], second[1] + second[3])
    return left, bottom, max(0, right - left), max(0, top - bottom)
