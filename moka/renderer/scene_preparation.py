"""Makes what stays the same from frame to frame, whenever it changes."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.renderer.frame_order import PASS_SCENE
from moka.renderer.frame_scene import FrameScene
from moka.renderer.gather import DrawGatherer
from moka.renderer.light_sources import LightSources, light_capacity
from moka.renderer.permutation import LightingDescription
from moka.renderer.prepared_scene import PreparedScene, SharedBindings
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.settings import RenderSettings
from moka.renderer.shared_pools import SharedPools
from moka.renderer.view import look_through
from moka.scene.camera import Camera
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.renderer.pose_texture import PoseTexture

__all__ = ["ScenePreparation"]


class ScenePreparation:
    """The prepared scene of one renderer, and what gathers its draws.

    ``frame`` is the uniform buffer of the block ``Frame``. ``key`` is another
    one when anything has been made anew.
    """

    prepared: PreparedScene
    gatherer: DrawGatherer

    def __init__(
        self,
        device: GraphicsDevice,
        frame: Handle,
        sources: LightSources,
        pools: SharedPools,
    ) -> None:
        self._device = device
        self._frame = frame
        self._sources = sources
        self._pools = pools
        self._has_prepared = False
        self._poses: PoseTexture | None = None
        self.key: object = None

    def forget(self) -> None:
        """Make everything anew: programs or maps may be others."""
        self.key = None

    def look(
        self,
        scene: Scene,
        camera: Camera,
        size: tuple[int, int],
        settings: RenderSettings,
    ) -> FrameScene:
        """Bring ``scene`` up to date, and see it in a picture of ``size``."""
        scene.update()
        materials = self._pools.materials.describe(
            scene, camera, size, settings.textures
        )
        self._update_poses(scene, materials)
        width, height = size
        view = look_through(
            camera, width / height, reversed_z=self._device.info.clip_control
        )
        smallest = 0.0 if settings.accumulates else settings.cull_pixels
        visible = scene.visible(camera, width / height, smallest / height)
        return FrameScene(
            scene, materials, view, np.flatnonzero(visible), self._poses
        )

    def _update_poses(self, scene: Scene, materials: SceneMaterials) -> None:
        """Have the texture of what moves within itself, if anything does."""
        if self._poses is not None:
            if self._poses.made_for is materials:
                return
            self._poses.destroy()
            self._poses = None
        poses = scene.drawables.poses
        if poses is not None:
            from moka.renderer.pose_texture import PoseTexture

            self._poses = PoseTexture(
                self._device, poses, scene.drawables.primitives, materials
            )

    def update(
        self,
        seen: FrameScene,
        settings: RenderSettings,
        lights: NDArray[np.void],
        visibility: int = 0,
    ) -> PreparedScene:
        """What a frame that has ``seen`` a scene needs, made if need be.

        ``lights`` are the frame's rows of lights, ``visibility`` is how many
        samples of a pixel a visibility buffer has. After :meth:`look` and
        when the maps of the light are there.
        """
        materials, drawables = seen.materials, seen.scene.drawables
        capacity = light_capacity(len(lights)) if materials.has_lit else 0
        lighting = self._describe(
            seen,
            settings,
            capacity,
            positional=bool(lights["positional"].any()),
            visibility=visibility,
        )
        key = (self._pools.materials.key, lighting)
        if self._has_prepared and self.key == key:
            return self.prepared
        if self._has_prepared:
            self.prepared.destroy()
        sources, poses = self._sources, seen.poses
        needs_table = lighting.needs_table and materials.has_lit
        self.prepared = PreparedScene(
            self._device,
            drawables.primitives,
            materials,
            lighting,
            SharedBindings(
                self._frame,
                sources.buffer(capacity) if capacity else None,
                sources.maps,
                sources.table(settings.brdf) if needs_table else None,
                () if poses is None else poses.bindings,
            ),
            self._pools.programs,
            self._pools.geometry,
            self._pools.materials.textures,
        )
        self._has_prepared = True
        self.key = key
        surface = self.prepared.visible_surface
        self.gatherer = DrawGatherer(
            drawables,
            self.prepared,
            PASS_SCENE,
            None if poses is None else poses.places,
            None if surface is None else surface.places,
            0 if surface is None else surface.triangle_bits,
        )
        return self.prepared

    def _describe(
        self,
        seen: FrameScene,
        settings: RenderSettings,
        capacity: int,
        *,
        positional: bool,
        visibility: int,
    ) -> LightingDescription:
        maps = self._sources.maps
        # Irradiance is what white plaster would show.
        is_bare = settings.light_part == "irradiance"
        # Of uniform light split-sum is exact, and there is no such cube.
        is_uniform = settings.ibl == "filtered" and maps.radiance is None
        is_plain = settings.ibl == "off" or is_uniform
        return LightingDescription(
            maps.lights_surfaces and settings.ibl != "off",
            capacity,
            settings.brdf,
            "lambert" if is_bare else settings.diffuse,
            settings.multiscatter and not is_bare,
            settings.has_float_target,
            self._sources.harmonics is not None,
            "split-sum" if is_plain else settings.ibl,
            seen.view.depth_range is not None,
            positional,
            seen.scene.environment_rotation != 0,
            settings.light_part,
            visibility=visibility,
        )
