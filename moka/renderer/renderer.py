"""The order of a frame: a scene becomes passes, packets and pixels.

    scene pass    opaque, then masked, then blended back to front; linear,
                  multisampled
    accumulation  of reference lighting, whose frames have the environment
                  behind them: frames so far, averaged
    display pass  samples averaged, the environment behind them; exposed,
                  tone mapped, encoded
    values pass   where AOVs are asked for: what surfaces are, unlit

What does not change between frames is prepared once
(:mod:`moka.renderer.prepared_scene`); a frame itself is array operations:
cull, key, gather (:mod:`moka.renderer.gather`).
"""

from collections.abc import Callable, Hashable, Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.descriptors import BufferDescriptor, BufferUsage
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey, Stage
from moka.core.errors import DeviceError
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.graphics.program_cache import ProgramCache
from moka.graphics.shader_source import forget_shaders
from moka.lighting.disk_cache import DiskCache
from moka.renderer.frame_block import FRAME, frame_values
from moka.renderer.geometry import GeometryPool
from moka.renderer.light_sources import (
    LightSources,
    MadeLighting,
    MapNeeds,
    light_capacity,
)
from moka.renderer.material_pool import MaterialPool
from moka.renderer.prepared_scene import LAYER_BACKGROUND, PreparedScene
from moka.renderer.progressive import Progressive
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.scene_preparation import ScenePreparation
from moka.renderer.screen_passes import ScreenPasses, Sky
from moka.renderer.settings import RenderSettings
from moka.renderer.sky_map import SkyMap
from moka.renderer.targets import Targets
from moka.renderer.view import View, look_through
from moka.renderer.visibility_choice import VisibilityChoice
from moka.scene.camera import Camera
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.model.mesh import Primitive
    from moka.renderer.debug_view import DebugPass
    from moka.renderer.geometry import Upload
    from moka.renderer.surface_values import SurfaceValues, ValueTargets
    from moka.renderer.visibility_buffer import VisibilityBuffer

__all__ = ["Renderer"]

PASS_SCENE = 1
PASS_ACCUMULATE = 2
PASS_DISPLAY = 3
PASS_VALUES = 4
PASS_DEBUG = 5
PASS_READ = 6


class Renderer:
    """Draws scenes on one device.

    ``size`` is the picture's width and height in pixels, ``settings`` how it
    is made; both may be replaced between frames. With ``to_window`` the
    display pass ends in the device's window, else in a texture that
    :meth:`read_display` reads. ``statistics`` collects times and counters.
    ``cache`` is where preintegrated lighting is looked for, and written to
    by :meth:`keep_lighting`. ``materials`` is a pool of this device in which
    images may be decoding already; the renderer closes it. One that is
    ``beside`` another of its device shares programs, geometry, textures and
    the cache with it, and closes nothing; both are to draw the same scene
    with the same :attr:`RenderSettings.textures`, each into command lists of
    its own.

    With ``shows_stops`` the display has a colour for each stop of luminance
    in the place of what the picture looks like. Only the pixels of ``area``
    (x, y, width, height from the lower left) are drawn, None is all;
    reference lighting keeps its samples when the area changes. With
    ``at_centres`` its samples all see the centre of their pixel, as a mode
    without multisampling does.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        size: tuple[int, int] = (1280, 720),
        settings: RenderSettings | None = None,
        *,
        to_window: bool = False,
        statistics: Statistics | None = None,
        cache: DiskCache | None = None,
        materials: MaterialPool | None = None,
        beside: "Renderer | None" = None,
    ) -> None:
        self.device = device
        self.size = size
        self.settings = settings or RenderSettings()
        self.statistics = statistics or Statistics()
        self.shows_stops = False
        self.area: tuple[int, int, int, int] | None = None
        self.at_centres = False
        self._to_window = to_window
        self._cache = cache
        self._is_guest = beside is not None
        if beside is None:
            self._passes = FullscreenPasses(device)
            self._programs = ProgramCache(device)
            self._geometry = GeometryPool(device)
            self._materials = materials or MaterialPool(device, self.statistics)
        else:
            self._passes = beside._passes
            self._programs = beside._programs
            self._geometry = beside._geometry
            self._materials = beside._materials
            cache = beside._cache
        passes = self._passes
        self._progressive = Progressive(device, passes)
        self._screen = ScreenPasses(device, passes)
        self._sky_map = SkyMap(device)
        self._sources = LightSources(device, passes, self.statistics, cache)
        self._frame = device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM, FRAME.size, dynamic=True, label="frame"
            ),
            np.zeros(FRAME.size, np.uint8),
        )
        self._targets: Targets | None = None
        self._visibility_choice = VisibilityChoice(device, self._geometry)
        self._visibility: VisibilityBuffer | None = None
        # What the scene of the last frame has behind it, not drawn there.
        self._sky_behind: Sky | None = None
        self._scene = ScenePreparation(
            device,
            self._frame,
            self._sources,
            self._programs,
            self._geometry,
            self._materials,
            PASS_SCENE,
        )
        self._values: SurfaceValues | None = None
        self._debug: DebugPass | None = None

    def close(self) -> None:
        """Stop the decoding threads; resources go with the device."""
        if not self._is_guest:
            self._materials.close()

    def release_targets(self) -> None:
        """Give back what pictures are drawn into, until the next one."""
        if self._visibility is not None:
            self._visibility.destroy()
            self._visibility = None
        if self._targets is not None:
            self._screen.forget()
            self._progressive.forget()
            self._targets.destroy()
            self._targets = None

    def reload_shaders(self) -> int:
        """Compile the shaders whose files have changed; says how many.

        Raises ShaderError where one does not compile; the picture then is
        made as before.
        """
        forget_shaders()
        try:
            return self._programs.reload() + self._passes.reload()
        finally:
            # What is prepared names programs by handles that may be gone.
            self._scene.forget()
            if self._values is not None:
                self._values.forget()

    @property
    def has_lighting_to_keep(self) -> bool:
        """Whether :meth:`keep_lighting` would write anything."""
        return self._sources.has_something_to_keep

    def keep_lighting(self) -> None:
        """Write preintegrated lighting that is new to the cache, if any.

        Waits for the GPU and the disk: call it when nobody else waits.
        """
        self._sources.keep()

    def prepare_geometry(
        self,
        primitives: "Sequence[Primitive]",
        told: Callable[[str, int, int], None],
    ) -> "list[Upload]":
        """Decode and upload what ``primitives`` are drawn with.

        On a thread that may wait, while another one draws. ``told`` gets
        what is being done (``meshes`` or ``images``), how many are, and of
        how many; what it raises ends it. Raises ImageFileError for an image
        that cannot be had.
        """
        materials = self._materials.begin_primitives(
            primitives, self.settings.textures
        )
        attributes = [each.attributes for each in materials.descriptions]
        # While the images decode.
        uploads = self._geometry.make(
            list(zip(primitives, attributes, strict=True)),
            partial(told, "meshes"),
        )
        self._materials.finish(materials, partial(told, "images"))
        return uploads

    def adopt_geometry(self, uploads: "list[Upload]") -> None:
        """Have what was prepared for a scene that is drawn next."""
        self._geometry.adopt(uploads)

    def prepare_lighting(
        self,
        environment: Any,
        scene: Scene,
        settings: RenderSettings,
        told: Callable[[int, int], None],
    ) -> MadeLighting | None:
        """What will light ``scene`` with ``environment``, whatever it shows.

        With ``settings``, which may be those that come next; None if that is
        there already. On a thread that may wait, while another one draws.
        ``told`` gets how many pieces are done, and of how many; what it
        raises ends it.
        """
        needs = _map_needs(scene, settings, is_lit=True, has_diffuse=True)
        return self._sources.prepare(environment, needs, told)

    def adopt_lighting(self, lighting: MadeLighting) -> None:
        """Light with it from now on, if the scene has that environment."""
        self._sources.adopt(lighting)

    def draw(self, scene: Scene, camera: Camera, commands: CommandList) -> None:
        """Record a frame of ``scene`` seen by ``camera`` into ``commands``.

        Reference lighting takes several frames, see :attr:`is_complete`.
        Raises ModelError or ImageFileError for what a material needs and
        cannot be had.
        """
        scene.update()
        materials = self._materials.describe(
            scene, camera, self.size, self.settings.textures
        )
        self._scene.update_poses(scene, materials)
        width, height = self.size
        is_reversed = self.device.info.clip_control
        view = look_through(camera, width / height, reversed_z=is_reversed)
        # Before anything that may have to wait for images.
        samples = self._visibility_choice.samples(
            self.settings, materials, scene.drawables
        )
        targets = self._update_targets(samples)
        self._update_maps(scene, materials)
        lights = self._sources.rows(scene, view.position)
        prepared = self._scene.update(
            scene,
            materials,
            self.settings,
            lights,
            float_target=self._has_float_target,
            logarithmic_depth=view.depth_range is not None,
            visibility=samples,
        )
        visible = self._visible(scene, camera)
        if self._accumulates:
            self._progressive.begin(
                self._picture_key(scene, view, lights),
                targets,
                self.settings.sample_budget,
                self.settings.max_error,
                self.area,
            )
            if not self.at_centres:
                view = view.jittered(self._progressive.jitter, self.size)
        if not self._accumulates or not self._progressive.is_finished:
            self._draw_scene(
                scene, view, lights, visible, targets, prepared, commands
            )
        self._draw_display(scene, targets, commands)
        self._count(scene, prepared, len(visible))

    def read_display(self, commands: CommandList) -> Readback:
        """Read the tone mapped bytes (H, W, 4), bottom row first.

        To be recorded after :meth:`draw`.
        """
        return self._read(commands, self._current_targets.display, "u1")

    def read_radiance(self, commands: CommandList) -> Readback:
        """Read linear radiance (H, W, 4) float32, bottom row first.

        Premultiplied by coverage; a background colour is not part of it. To
        be recorded after :meth:`draw`.
        """
        targets = self._current_targets
        key = SortKey(PASS_READ)
        if targets.samples == 1 and self._sky_behind is None:
            return self._read(commands, targets.scene, "f4")
        self._screen.resolve(
            commands.command_buffer(key), targets, self._sky_behind
        )
        return self._read(commands, targets.resolved, "f4")

    def draw_values(
        self,
        scene: Scene,
        camera: Camera,
        names: Iterable[str],
        commands: CommandList,
    ) -> "ValueTargets":
        """Record what the surfaces of ``scene`` are, without light.

        ``names`` are of :data:`moka.core.aov.AOVS`. Returns the targets that
        hold them until this is called again.
        """
        from moka.renderer.surface_values import SurfaceValues, groups_of

        scene.update()
        materials = self._materials.describe(
            scene, camera, self.size, self.settings.textures
        )
        self._scene.update_poses(scene, materials)
        width, height = self.size
        is_reversed = self.device.info.clip_control
        view = look_through(camera, width / height, reversed_z=is_reversed)
        if self._values is None:
            self._values = SurfaceValues(
                self.device,
                self._frame,
                self._programs,
                self._geometry,
                self._materials.textures,
            )
        commands.fill_buffer(
            self._frame,
            self._frame_values(scene, view, 0),
            key=SortKey(PASS_VALUES),
        )
        return self._values.draw(
            scene,
            materials,
            view,
            self._visible(scene, camera),
            groups_of(names),
            self.size,
            commands,
            PASS_VALUES,
            self._scene.poses,
        )

    def draw_debug_view(
        self, scene: Scene, camera: Camera, name: str, commands: CommandList
    ) -> None:
        """Record a frame that shows what surfaces are, as colours.

        ``name`` is one of :data:`moka.renderer.debug_view.DEBUG_VIEWS`. It
        goes where :meth:`draw` would have the picture.
        """
        from moka.renderer.debug_view import DEBUG_VIEWS, DebugPass

        view = DEBUG_VIEWS[name]
        values = self.draw_values(scene, camera, (view.value,), commands)
        if self._debug is None:
            self._debug = DebugPass(self.device, self._passes)
        bounds = scene.bounds()
        distance = 1.0
        if bounds is not None:
            centre = np.mean(bounds, axis=0)
            distance = float(np.linalg.norm(camera.position - centre)) or 1.0
        target = None if self._to_window else self._update_targets().display
        self._debug.draw(
            view,
            values,
            distance,
            commands,
            SortKey(PASS_DEBUG),
            target,
            self.size,
        )

    def read_values(
        self,
        scene: Scene,
        camera: Camera,
        names: Iterable[str],
        commands: CommandList,
    ) -> dict[str, Readback]:
        """:meth:`draw_values`, and read them.

        What arrives is for
        :func:`moka.renderer.surface_values.unpack_values`.
        """
        targets = self.draw_values(scene, camera, names, commands)
        return targets.read(commands, SortKey(PASS_READ))

    @property
    def is_complete(self) -> bool:
        """Whether another frame of the same scene would show the same.

        Not before reference lighting has all its samples or, as far as the
        GPU has told, a small enough error.
        """
        return not self._accumulates or self._progressive.is_finished

    @property
    def lighting_statistics(self) -> dict[str, Any]:
        """How the last frames were lit, as the statistics file has it."""
        settings = self.settings
        samples, error = 0.0, None
        if settings.ibl == "filtered":
            samples = float(settings.ibl_samples)
        elif self._accumulates:
            self._progressive.take_report()
            samples = round(self._progressive.samples_per_pixel, 2)
            error = self._progressive.estimated_error
        return {
            "mode": settings.ibl,
            "samples_per_pixel": samples,
            "estimated_error": error,
        }

    @property
    def has_drawn(self) -> bool:
        """Whether there is a picture to read."""
        return self._targets is not None

    @property
    def _accumulates(self) -> bool:
        return self.settings.ibl == "reference"

    @property
    def _has_float_target(self) -> bool:
        return self.settings.float_output or self._accumulates

    @property
    def _current_targets(self) -> Targets:
        if self._targets is None:
            raise DeviceError("renderer: nothing has been drawn to read")
        return self._targets

    def _read(
        self, commands: CommandList, framebuffer: Handle, dtype: str
    ) -> Readback:
        return commands.read_pixels(
            framebuffer, (0, 0, *self.size), dtype=dtype, key=SortKey(PASS_READ)
        )

    def _update_maps(self, scene: Scene, materials: SceneMaterials) -> None:
        needs = _map_needs(
            scene,
            self.settings,
            is_lit=materials.has_lit,
            has_diffuse=materials.has_diffuse,
        )
        if self._sources.update_maps(scene.environment, needs):
            self._screen.forget()
            self._sky_map.forget()
            self._scene.forget()

    def _visible(self, scene: Scene, camera: Camera) -> NDArray[np.intp]:
        width, height = self.size
        pixels = 0.0 if self._accumulates else self.settings.cull_pixels
        return np.flatnonzero(
            scene.visible(camera, width / height, pixels / height)
        )

    def _update_targets(self, visible_samples: int = 0) -> Targets:
        settings = self.settings
        samples = min(settings.samples, self.device.info.max_samples)
        float_output = self._has_float_target
        if self._accumulates:
            samples = 1  # Edges are smooth by another point in every frame.
        if visible_samples:
            samples = 1  # The visibility buffer has them.
        wanted = (self.size, samples, float_output)
        if self._targets is None or self._targets.made_for != wanted:
            self.release_targets()
            self._targets = Targets(
                self.device, self.size, samples, float_output=float_output
            )
        self._update_visibility(self._targets, visible_samples)
        return self._targets

    def _update_visibility(self, targets: Targets, samples: int) -> None:
        visibility = self._visibility
        if visibility is not None and visibility.made_for == (targets, samples):
            return
        if visibility is not None:
            visibility.destroy()
            self._visibility = None
        if samples:
            from moka.renderer.visibility_buffer import VisibilityBuffer

            self._visibility = VisibilityBuffer(
                self.device, self._passes, targets, samples
            )

    def _draw_scene(
        self,
        scene: Scene,
        view: View,
        lights: NDArray[np.void],
        visible: NDArray[np.intp],
        targets: Targets,
        prepared: PreparedScene,
        commands: CommandList,
    ) -> None:
        is_reversed = self.device.info.clip_control
        capacity = light_capacity(len(lights)) if prepared.is_lit else 0
        if self._scene.poses is not None:
            self._scene.poses.update(visible, self._geometry, commands)
        setup = commands.command_buffer(SortKey(PASS_SCENE))
        setup.fill_buffer(
            self._frame,
            self._frame_values(
                scene,
                view,
                len(lights),
                prepared.visible_surface.triangle_bits
                if prepared.visible_surface
                else 0,
            ),
        )
        if scene.live_materials is not None:
            prepared.update_materials(scene.live_materials, setup)
        if capacity:
            setup.fill_buffer(
                self._sources.buffer(capacity), lights.view(np.uint8)
            )
        # Black is opaque where the environment should be and is not.
        is_dark = (
            scene.background == "environment" and self._sources.maps.map is None
        )
        clear = (0.0, 0.0, 0.0, float(is_dark))
        if self._visibility is not None:
            self._visibility.begin(setup, self.area)
        else:
            setup.bind_framebuffer(targets.scene)
            setup.clear(clear, 0.0 if is_reversed else 1.0)
            if self._accumulates:
                self._progressive.mask(setup, 1.0 if is_reversed else 0.0)
            elif self.area is not None:
                setup.scissor(self.area)
        states = np.array(
            [commands.state_index(state) for state in prepared.states],
            np.uint32,
        )
        commands.use(prepared.handles)
        draws, instances = self._scene.gatherer.gather(
            scene.transforms, visible, view, states
        )
        commands.draws(draws, instances, in_order=True)
        if self._visibility is not None:
            self._visibility.shade(
                commands,
                SortKey(PASS_SCENE, LAYER_BACKGROUND),
                prepared,
                instances,
                clear,
                self.area,
            )
        self._sky_behind = self._sky(scene, view)
        if self._accumulates:
            # What is averaged over frames has its sky in every one of them.
            if self._sky_behind is not None:
                key = SortKey(PASS_SCENE, LAYER_BACKGROUND, Stage.OPAQUE)
                self._screen.draw_background(commands, key, self._sky_behind)
                self._sky_behind = None
            self._progressive.accumulate(
                commands, SortKey(PASS_ACCUMULATE), targets
            )

    def _picture_key(
        self, scene: Scene, view: View, lights: NDArray[np.void]
    ) -> Hashable:
        """All that radiance depends on: the same while samples add up."""
        return (
            self._scene.key,
            id(scene.environment),
            scene.environment_rotation,
            scene.environment_intensity,
            scene.background == "environment",
            scene.background_blur,
            scene.transforms.version,
            scene.pose_version,
            scene.visibility_version,
            scene.live_materials and scene.live_materials.version,
            view.position.tobytes(),
            view.clip_from_world.tobytes(),
            lights.tobytes(),
        )

    def _frame_values(
        self,
        scene: Scene,
        view: View,
        light_count: int,
        triangle_bits: int = 0,
    ) -> NDArray[np.void]:
        samples = (0, self.settings.ibl_samples, 0, 0)
        if self._accumulates:
            samples = self._progressive.sample_range
        return frame_values(
            scene,
            view,
            self.size,
            harmonics=self._sources.harmonics,
            specular_levels=self._sources.maps.specular_levels,
            light_count=light_count,
            sample_range=samples,
            triangle_bits=triangle_bits,
        )

    def _sky(self, scene: Scene, view: View) -> Sky | None:
        environment_map = self._sources.maps.map
        if scene.background != "environment" or environment_map is None:
            return None
        cube, suns = None, scene.environment.suns
        if scene.background_blur > 0.0:
            cube, suns = self._sources.maps.specular, self._sources.suns
        elif self._sources.map_shows_suns:
            environment_map = self._sky_map.without_suns(scene.environment)
        return Sky(
            environment_map,
            view,
            rotation=scene.environment_rotation,
            intensity=scene.environment_intensity,
            float_target=self._has_float_target,
            suns=suns,
            height=self.size[1],
            cube=cube,
            levels=self._sources.maps.specular_levels,
            blur=scene.background_blur,
        )

    def _draw_display(
        self, scene: Scene, targets: Targets, commands: CommandList
    ) -> None:
        colour = scene.background
        self._screen.draw_display(
            commands,
            SortKey(PASS_DISPLAY),
            targets,
            self._sky_behind,
            tone_map="stops" if self.shows_stops else self.settings.tone_map,
            exposure=self.settings.exposure,
            gamma=None if self.shows_stops else self.settings.gamma,
            background=None if isinstance(colour, str) else colour,
            window=self.size if self._to_window else None,
            area=self.area,
        )

    def _count(
        self, scene: Scene, prepared: PreparedScene, visible: int
    ) -> None:
        objects = scene.drawables.total
        for name, value in (
            ("objects", objects),
            ("visible", visible),
            ("culled", objects - visible),
            ("programs", len(self._programs)),
            ("permutations", prepared.permutation_count),
        ):
            self.statistics.set_count(name, value)


def _map_needs(
    scene: Scene, settings: RenderSettings, *, is_lit: bool, has_diffuse: bool
) -> MapNeeds:
    """What of an environment ``scene`` shows, whichever it is."""
    shows_irradiance = is_lit and settings.light_part == "irradiance"
    reflects = settings.ibl != "off"
    has_background = scene.background == "environment"
    return MapNeeds(
        background=has_background,
        specular=is_lit and reflects,
        irradiance=(has_diffuse or shows_irradiance) and reflects,
        suns=settings.suns if reflects else "off",
        irradiance_as=settings.irradiance,
        ibl=settings.ibl,
        reflections=settings.reflections,
        blurred=has_background and scene.background_blur > 0.0,
    )
