"""The order of a frame: a scene becomes passes, packets and pixels.

    scene pass    opaque, then masked, then blended back to front; linear,
                  multisampled. Or what each sample sees is noted, and each
                  pixel shaded once (:mod:`moka.renderer.visibility_buffer`)
    accumulation  of reference lighting, whose frames have the environment
                  behind them: frames so far, averaged
    display pass  samples averaged, the environment behind them; exposed,
                  tone mapped, encoded
    values pass   where AOVs are asked for: what surfaces are, unlit

What does not change between frames is prepared once
(:mod:`moka.renderer.prepared_scene`); a frame itself is array operations:
cull, key, gather (:mod:`moka.renderer.gather`).
"""

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.descriptors import BufferDescriptor, BufferUsage
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey, Stage
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.shader_source import forget_shaders
from moka.lighting.disk_cache import DiskCache
from moka.renderer.frame_block import FRAME
from moka.renderer.frame_order import (
    LAYER_BACKGROUND,
    PASS_ACCUMULATE,
    PASS_DISPLAY,
    PASS_READ,
    PASS_SCENE,
)
from moka.renderer.frame_scene import FrameScene, radiance_key
from moka.renderer.frame_targets import FrameTargets
from moka.renderer.light_sources import LightSources, MadeLighting
from moka.renderer.map_needs import map_needs
from moka.renderer.material_pool import MaterialPool
from moka.renderer.progressive import Progressive
from moka.renderer.scene_pass import ScenePass
from moka.renderer.scene_preparation import ScenePreparation
from moka.renderer.screen_passes import ScreenPart, ScreenPasses
from moka.renderer.settings import RenderSettings
from moka.renderer.shared_pools import SharedPools
from moka.renderer.sky import Sky
from moka.renderer.sky_map import SkyMap
from moka.renderer.targets import Targets
from moka.renderer.visibility_choice import VisibilityChoice
from moka.scene.camera import Camera
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.model.mesh import Primitive
    from moka.renderer.geometry import Upload
    from moka.renderer.surface_pictures import SurfacePictures
    from moka.renderer.surface_values import ValueTargets

__all__ = ["Renderer"]


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
        self._is_guest = beside is not None
        self._pools: SharedPools = (
            SharedPools(device, self.statistics, materials, cache)
            if beside is None
            else beside._pools
        )
        passes = self._pools.passes
        self._progressive = Progressive(device, passes)
        self._screen = ScreenPasses(device, passes)
        self._sources = LightSources(
            device, passes, self.statistics, self._pools.cache
        )
        self._sky_map = SkyMap(device, self._sources)
        self._frame = device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM, FRAME.size, dynamic=True, label="frame"
            ),
            np.zeros(FRAME.size, np.uint8),
        )
        self._targets = FrameTargets(
            device, passes, (self._screen, self._progressive)
        )
        self._visibility_choice = VisibilityChoice(device, self._pools.geometry)
        # What the scene of the last frame has behind it, not drawn there.
        self._sky_behind: Sky | None = None
        # Of how many samples its depth alone says where something is: there
        # its radiance holds nothing else.
        self._marked = 0
        self._scene = ScenePreparation(
            device, self._frame, self._sources, self._pools
        )
        self._scene_pass = ScenePass(
            device,
            self._frame,
            self._sources,
            self._pools.geometry,
            self._scene,
            self._targets,
            self._progressive,
        )
        self._pictures: SurfacePictures | None = None

    def close(self) -> None:
        """Stop the decoding threads; resources go with the device."""
        if not self._is_guest:
            self._pools.materials.close()

    def release_targets(self) -> None:
        """Give back what pictures are drawn into, until the next one."""
        self._targets.release()

    def reload_shaders(self) -> int:
        """Compile the shaders whose files have changed; says how many.

        Raises ShaderError where one does not compile; the picture then is
        made as before.
        """
        forget_shaders()
        try:
            return self._pools.programs.reload() + self._pools.passes.reload()
        finally:
            # What is prepared names programs by handles that may be gone.
            self._scene.forget()
            if self._pictures is not None:
                self._pictures.forget()

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
        return self._pools.prepare_geometry(
            primitives, self.settings.textures, told
        )

    def adopt_geometry(self, uploads: "list[Upload]") -> None:
        """Have what was prepared for a scene that is drawn next."""
        self._pools.geometry.adopt(uploads)

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
        needs = map_needs(scene, settings, is_lit=True, has_diffuse=True)
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
        seen = self._look(scene, camera)
        # What can be, and programs above all, before what waits for images.
        samples = self._visibility_choice.samples(
            self.settings, seen.materials, scene.drawables
        )
        targets = self._targets.update(
            self.size,
            self.settings,
            samples,
            has_edges=len(scene.drawables.primitive) > 0,
        )
        self._update_maps(seen)
        lights = self._sources.rows(scene, seen.view.position)
        # Frames that are accumulated have theirs in every one of them.
        self._sky_behind = (
            None if self.settings.accumulates else self._sky(seen)
        )
        # A window has no such depth.
        has_marks = self._sky_behind is not None and not self._to_window
        self._marked = self._targets.marked_samples if has_marks else 0
        display = self._display_parts(scene, targets)
        prepared = self._scene.update(seen, self.settings, lights, samples)
        if self.settings.accumulates:
            self._progressive.begin(
                radiance_key(seen, self._scene.key, lights),
                targets,
                self.settings.sample_budget,
                self.settings.max_error,
                self.area,
            )
        if not self.settings.accumulates or not self._progressive.is_finished:
            self._draw_scene(seen, lights, targets, commands)
        self._draw_display(scene, display, targets, commands)
        self._count(
            seen, prepared.permutation_count, samples or targets.samples
        )

    def read_display(self, commands: CommandList) -> Readback:
        """Read the tone mapped bytes (H, W, 4), bottom row first.

        To be recorded after :meth:`draw`.
        """
        return self._read(commands, self._targets.current.display, "u1")

    def read_radiance(self, commands: CommandList) -> Readback:
        """Read linear radiance (H, W, 4) float32, bottom row first.

        Premultiplied by coverage; a background colour is not part of it. To
        be recorded after :meth:`draw`.
        """
        targets = self._targets.current
        key = SortKey(PASS_READ)
        if targets.samples == 1 and self._sky_behind is None:
            return self._read(commands, targets.scene, "f4")
        self._screen.resolve(
            commands.command_buffer(key),
            targets,
            self._sky_behind,
            self._marked,
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
        seen = self._look(scene, camera)
        return self._surface_pictures().draw_values(
            seen, names, self.size, commands
        )

    def draw_debug_view(
        self, scene: Scene, camera: Camera, name: str, commands: CommandList
    ) -> None:
        """Record a frame that shows what surfaces are, as colours.

        ``name`` is one of :data:`moka.renderer.debug_view.DEBUG_VIEWS`. It
        goes where :meth:`draw` would have the picture.
        """
        seen = self._look(scene, camera)
        target = None
        if not self._to_window:
            target = self._targets.update(self.size, self.settings).display
        self._surface_pictures().draw_view(
            seen, name, self.size, commands, target
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
        return not self.settings.accumulates or self._progressive.is_finished

    @property
    def lighting_statistics(self) -> dict[str, Any]:
        """How the last frames were lit, as the statistics file has it."""
        settings = self.settings
        samples, error = 0.0, None
        if settings.ibl == "filtered":
            samples = float(settings.ibl_samples)
        elif settings.accumulates:
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
        return self._targets.exist

    def _look(self, scene: Scene, camera: Camera) -> FrameScene:
        return self._scene.look(scene, camera, self.size, self.settings)

    def _update_maps(self, seen: FrameScene) -> None:
        needs = map_needs(
            seen.scene,
            self.settings,
            is_lit=seen.materials.has_lit,
            has_diffuse=seen.materials.has_diffuse,
        )
        if self._sources.update_maps(seen.scene.environment, needs):
            self._screen.forget()
            self._sky_map.forget()
            self._scene.forget()

    def _draw_scene(
        self,
        seen: FrameScene,
        lights: NDArray[np.void],
        targets: Targets,
        commands: CommandList,
    ) -> None:
        settings = self.settings
        if settings.accumulates and not self.at_centres:
            jitter = self._progressive.jitter
            seen = replace(seen, view=seen.view.jittered(jitter, self.size))
        self._scene_pass.draw(
            seen,
            settings,
            self.size,
            lights,
            self.area,
            commands,
            clears=not self._marked,
        )
        if settings.accumulates:
            sky = self._sky(seen)
            if sky is not None:
                key = SortKey(PASS_SCENE, LAYER_BACKGROUND, Stage.OPAQUE)
                self._screen.draw_background(commands, key, sky)
            self._progressive.accumulate(
                commands, SortKey(PASS_ACCUMULATE), targets
            )

    def _sky(self, seen: FrameScene) -> Sky | None:
        return self._sky_map.behind(
            seen.scene,
            seen.view,
            self.size[1],
            float_target=self.settings.has_float_target,
        )

    def _display_parts(
        self, scene: Scene, targets: Targets
    ) -> tuple[ScreenPart, ...]:
        return self._screen.display_parts(
            targets,
            self._sky_behind,
            self._marked,
            tone_map="stops" if self.shows_stops else self.settings.tone_map,
            has_gamma=self._gamma is not None,
            has_background=not isinstance(scene.background, str),
        )

    @property
    def _gamma(self) -> float | None:
        return None if self.shows_stops else self.settings.gamma

    def _draw_display(
        self,
        scene: Scene,
        parts: tuple[ScreenPart, ...],
        targets: Targets,
        commands: CommandList,
    ) -> None:
        colour = scene.background
        self._screen.draw_display(
            commands,
            SortKey(PASS_DISPLAY),
            parts,
            targets,
            self._sky_behind,
            exposure=self.settings.exposure,
            gamma=self._gamma,
            background=None if isinstance(colour, str) else colour,
            window=self.size if self._to_window else None,
            area=self.area,
        )

    def _surface_pictures(self) -> "SurfacePictures":
        if self._pictures is None:
            from moka.renderer.surface_pictures import SurfacePictures

            self._pictures = SurfacePictures(
                self.device, self._frame, self._pools
            )
        return self._pictures

    def _read(
        self, commands: CommandList, framebuffer: Handle, dtype: str
    ) -> Readback:
        return commands.read_pixels(
            framebuffer, (0, 0, *self.size), dtype=dtype, key=SortKey(PASS_READ)
        )

    def _count(self, seen: FrameScene, permutations: int, samples: int) -> None:
        objects, visible = seen.scene.drawables.total, len(seen.visible)
        for name, value in (
            ("objects", objects),
            ("visible", visible),
            ("culled", objects - visible),
            ("programs", len(self._pools.programs)),
            ("permutations", permutations),
            ("samples", samples),
        ):
            self.statistics.set_count(name, value)
