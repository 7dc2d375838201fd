"""Makes what stays the same from frame to frame, whenever it changes."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.program_cache import ProgramCache
from moka.renderer.gather import DrawGatherer
from moka.renderer.geometry import GeometryPool
from moka.renderer.light_sources import LightSources, light_capacity
from moka.renderer.material_pool import MaterialPool
from moka.renderer.permutation import LightingDescription
from moka.renderer.prepared_scene import PreparedScene, SharedBindings
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.settings import RenderSettings
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.renderer.pose_texture import PoseTexture

__all__ = ["ScenePreparation"]


class ScenePreparation:
    """The prepared scene of one renderer, and what gathers its draws.

    ``frame`` is the uniform buffer of the block ``Frame``, ``pass_`` the
    frame's pass that the draws belong to. ``poses`` is the texture of what
    moves within itself, None where nothing does. ``key`` is another one when
    anything has been made anew.
    """

    prepared: PreparedScene
    gatherer: DrawGatherer

    def __init__(
        self,
        device: GraphicsDevice,
        frame: Handle,
        sources: LightSources,
        programs: ProgramCache,
        geometry: GeometryPool,
        materials: MaterialPool,
        pass_: int,
    ) -> None:
        self._device = device
        self._frame = frame
        self._sources = sources
        self._programs = programs
        self._geometry = geometry
        self._materials = materials
        self._pass = pass_
        self._has_prepared = False
        self.poses: PoseTexture | None = None
        self.key: object = None

    def forget(self) -> None:
        """Make everything anew: programs or maps may be others."""
        self.key = None

    def update_poses(self, scene: Scene, materials: SceneMaterials) -> None:
        """Have the texture of what moves within itself, if anything does."""
        if self.poses is not None:
            if self.poses.made_for is materials:
                return
            self.poses.destroy()
            self.poses = None
        poses = scene.drawables.poses
        if poses is not None:
            from moka.renderer.pose_texture import PoseTexture

            self.poses = PoseTexture(
                self._device, poses, scene.drawables.primitives, materials
            )

    def update(
        self,
        scene: Scene,
        materials: SceneMaterials,
        settings: RenderSettings,
        lights: NDArray[np.void],
        *,
        float_target: bool,
        logarithmic_depth: bool,
        visibility: int = 0,
    ) -> PreparedScene:
        """What a frame of ``scene`` needs, made if it is not there.

        ``lights`` are the frame's rows of lights. After
        :meth:`update_poses` and when the maps of the light are there.
        """
        capacity = light_capacity(len(lights)) if materials.has_lit else 0
        lighting = self._describe(
            scene,
            settings,
            capacity,
            positional=bool(lights["positional"].any()),
            float_target=float_target,
            logarithmic_depth=logarithmic_depth,
            visibility=visibility,
        )
        key = (self._materials.key, lighting)
        if self._has_prepared and self.key == key:
            return self.prepared
        if self._has_prepared:
            self.prepared.destroy()
        sources, poses = self._sources, self.poses
        needs_table = lighting.needs_table and materials.has_lit
        self.prepared = PreparedScene(
            self._device,
            scene.drawables.primitives,
            materials,
            lighting,
            SharedBindings(
                self._frame,
                sources.buffer(capacity) if capacity else None,
                sources.maps,
                sources.table(settings.brdf) if needs_table else None,
                () if poses is None else poses.bindings,
            ),
            self._programs,
            self._geometry,
            self._materials.textures,
        )
        self._has_prepared = True
        self.key = key
        surface = self.prepared.visible_surface
        self.gatherer = DrawGatherer(
            scene.drawables,
            self.prepared,
            self._pass,
            None if poses is None else poses.places,
            None if surface is None else surface.places,
            0 if surface is None else surface.triangle_bits,
        )
        return self.prepared

    def _describe(
        self,
        scene: Scene,
        settings: RenderSettings,
        capacity: int,
        *,
        positional: bool,
        float_target: bool,
        logarithmic_depth: bool,
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
            float_target,
            self._sources.harmonics is not None,
            "split-sum" if is_plain else settings.ibl,
            logarithmic_depth,
            positional,
            scene.environment_rotation != 0,
            settings.light_part,
            visibility=visibility,
        )
