"""The viewer: a model in a window, and panels to look into it.

It draws on demand. Whatever takes long (reading a file, writing a picture)
is done in the background while the window answers; what goes wrong there is
told in the window, and the picture stays as it was.
"""

import math
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from msgspec.structs import replace

from moka.app.application import App, GameTime
from moka.app.command_text import command_text
from moka.app.events import (
    DropEvent,
    Event,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ScrollEvent,
)
from moka.app.keys import Key, Modifiers, MouseButton
from moka.app.render_session import RenderRequest
from moka.commands.command_list import CommandList
from moka.commands.commands import Readback, Timestamps
from moka.commands.sort_key import SortKey
from moka.core.errors import MokaError
from moka.core.image import Image
from moka.core.resources import asset_folder, shader_folder
from moka.lighting.environment import Environment, load_environment
from moka.model import Model, load_model
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.camera_choice import (
    Look,
    Orbit,
    choose_camera,
    look_text,
    parse_camera,
)
from moka.scene.drawables import ModelLayout
from moka.scene.lights import Light
from moka.scene.scene_model import SceneModel
from moka.ui.background_work import BackgroundWork
from moka.ui.comparison import Comparison
from moka.ui.draft import Draft
from moka.ui.file_watcher import FileWatcher
from moka.ui.frame_times import PASS_INTERFACE, FrameTimes, mark_passes
from moka.ui.interface import Interface
from moka.ui.lighting_error import SAMPLES, ErrorMeasurement
from moka.ui.orbit_controls import OrbitControls
from moka.ui.panels.camera import CameraPanel
from moka.ui.panels.comparison import ComparisonPanel
from moka.ui.panels.environment import EnvironmentPanel, LightingPanel
from moka.ui.panels.help import draw_help
from moka.ui.panels.inspector import InspectorPanel
from moka.ui.panels.lights import LightsPanel
from moka.ui.panels.model import ModelPanel
from moka.ui.panels.output import OutputPanel, unused_path
from moka.ui.panels.panel import Panel
from moka.ui.panels.picture import PicturePanel
from moka.ui.panels.profiler import ProfilerPanel
from moka.ui.panels.scene_tree import SceneTreePanel
from moka.ui.panels.timeline import draw_timeline, toggle_playing
from moka.ui.panels.view import ViewPanel
from moka.ui.picking import begin_pick, finish_pick
from moka.ui.preferences import (
    Preferences,
    save_preferences,
    with_recent,
)
from moka.ui.selection import draw_box

__all__ = ["Viewer"]

# Panels follow the pointer a frame later, and sizes of text one more.
_FRAMES_TO_SETTLE = 3

# A drag is not a click when the pointer has moved by more than this.
_CLICK = 4.0

# Seconds within which a second click makes a double click.
_DOUBLE_CLICK = 0.4

# Distances to the target per second of flight.
_FLIGHT = 1.0

# Of the window's height, a second; half a turn is the height.
_ROTATION = 0.2 / math.pi

_COLUMN = 300.0

MODEL_SUFFIXES = (".gltf", ".glb")
ENVIRONMENT_SUFFIXES = (".hdr", ".exr")


class Viewer(App):
    """Shows what ``request`` describes, and lets a person change it all.

    ``controls`` move the camera; ``model`` is what is open, None before it
    has been read; ``selection`` the row of a node of it. ``debug_view`` is
    a name of :data:`moka.renderer.debug_view.DEBUG_VIEWS` or None. ``error``
    is the last thing that went wrong, for a person to read. ``comparison``
    is what stands beside the picture, ``added_lights`` those that are no
    file's, ``message`` what to tell, ``measurement`` the last one of the
    light's error, ``times`` where the time of frames goes.
    """

    continuous = False

    def __init__(
        self,
        request: RenderRequest | None = None,
        preferences: Preferences | None = None,
    ) -> None:
        super().__init__()
        self.begun = request or RenderRequest()
        self.preferences = preferences or Preferences()
        self._remembers = preferences is not None
        self.controls = OrbitControls()
        self.model: SceneModel | None = None
        self.model_source: Any = self.begun.source
        self.environment_source: Any = self.begun.environment
        self.selection: int | None = None
        self.error: str | None = None
        self.debug_view: str | None = None
        self.shows_panels = self.preferences.shows_panels
        self.shows_help = False
        self.panels: list[Panel] = [
            ModelPanel(),
            CameraPanel(),
            PicturePanel(),
            EnvironmentPanel(),
            LightsPanel(),
            LightingPanel(),
            ViewPanel(),
            ComparisonPanel(),
            SceneTreePanel(),
            InspectorPanel(),
            ProfilerPanel(),
            OutputPanel(),
        ]
        self.added_lights: list[Light] = []
        self.auto_rotates = self.preferences.auto_rotates
        opened = self.preferences.open_panels
        if opened is not None:
            for panel in self.panels:
                panel.starts_open = panel.title in opened
        self.message: str | None = None
        self.times = FrameTimes()
        self.draft = Draft()
        self.comparison = Comparison()
        self.measurement: ErrorMeasurement | None = None
        self.interface: Interface
        self._work = BackgroundWork(self.request_redraw)
        self._watcher = FileWatcher(self._files_changed)
        self._changed: set[Path] = set()
        self._reads: list[tuple[list[Readback], Callable[[], None]]] = []
        self._wants_picture: Path | None = None
        self._settling = 0
        self._pressed_at: tuple[float, float] | None = None
        self._clicked = 0.0
        self._wants_pick: tuple[tuple[float, float], bool] | None = None
        self._camera_number = -1

    # What an App does.

    def load(self) -> None:
        """Begin to read the model and its environment."""
        scale = self.window.content_scale if self.window else 1.0
        self.interface = Interface(self.device, scale)
        begun = self.begun
        self.scene.background = begun.background
        self.scene.environment_rotation = begun.environment_rotation
        self.scene.environment_intensity = begun.environment_intensity
        self.scene.background_blur = begun.background_blur
        self.controls.apply(self.camera)
        self.open_environment(self.environment_source)
        self.open_model(self.model_source)

    def event(self, event: Event) -> None:
        """Panels first; what they do not want moves the camera."""
        self._settling = _FRAMES_TO_SETTLE
        self.interface.take(event)
        match event:
            case DropEvent(paths):
                for path in paths:
                    self.open(path)
            case KeyEvent(pressed=True) if not self.interface.wants_keyboard:
                self._press(event)
            case MouseButtonEvent():
                self._click(event)
            case MouseMoveEvent() if not self.interface.wants_pointer:
                self._drag(event)
            case ScrollEvent(dy=clicks) if not self.interface.wants_pointer:
                self.controls.zoom(clicks, self.camera, self._pointer())
                self._look()

    def update(self, time: GameTime) -> None:
        """Take over what the background has done, and fly."""
        try:
            self._work.poll()
            if self.measurement is not None:
                self.measurement.step()
        except MokaError as error:
            self.error = str(error)
            if self.measurement and not self.measurement.is_done:
                self.measurement = None
        self._reload()
        self._take_reads()
        self._fly(time.delta)
        if self.auto_rotates and not self._pressed_at:
            self.controls.orbit(-_ROTATION * time.delta, 0.0)
            self._look()
        if self._is_moving():
            self.draft.note_motion()
        if self.draft.is_moving:
            # Also for the whole picture when it rests.
            self.request_redraw()
        if self._settling or self._reads or self._work.doing:
            self._settling = max(self._settling - 1, 0)
        is_measuring = self.measurement and not self.measurement.is_done
        if self._settling or self._reads or is_measuring:
            self.request_redraw()
        if self.debug_view is None and not self.comparison.is_complete:
            self.request_redraw()

    def draw(self, time: GameTime, commands: CommandList) -> None:
        """The scene, then the panels over it."""
        size = self._window_size()
        pixels = self.window.framebuffer_size if self.window else self.size
        self.renderer.size = self._picture_size(size, pixels)
        self.times.add("wait", self.waited)
        self.draft.note_wait(self.waited)
        places = self.times.begin_frame()
        with self.times.stage("scene"):
            if places:
                mark_passes(commands, places[0])
            self._draw_picture(commands, places[1] if places else None)
            self._read_picture(commands)
            self._pick(commands, size)
        with (
            self.times.stage("panels"),
            self.interface.frame(size, time.delta) as imgui,
        ):
            self._draw_interface(imgui, size)
        with self.times.stage("draw panels"):
            self.interface.draw(commands, SortKey(PASS_INTERFACE), None, pixels)

    def close(self) -> None:
        """End the work in the background."""
        self._watcher.close()
        self._work.close()
        if self._remembers:
            save_preferences(self._chosen())
        for panel in self.panels:
            panel.close()
        self.interface.close()

    def _draw_picture(
        self, commands: CommandList, times: Timestamps | None
    ) -> None:
        settings = self.renderer.settings
        self.renderer.settings = self.draft.settings(settings)
        try:
            if self.debug_view is None and self.window is not None:
                self.comparison.draw(
                    self.renderer, self.scene, self.camera, None, times
                )
            self._draw_scene(commands)
        except MokaError as error:
            self.error = str(error)
            self._remove_model()
            self._draw_scene(commands)
        finally:
            self.renderer.settings = settings

    def _draw_scene(self, commands: CommandList) -> None:
        if self.debug_view is None:
            self.renderer.draw(self.scene, self.camera, commands)
        else:
            self.renderer.draw_debug_view(
                self.scene, self.camera, self.debug_view, commands
            )

    # What a person may want of it.

    @property
    def settings(self) -> RenderSettings:
        """How the picture is made."""
        return self.renderer.settings

    def change_settings(self, **changes: Any) -> None:
        """Replace settings by name, if they are others than now."""
        settings = self.renderer.settings
        if any(getattr(settings, name) != changes[name] for name in changes):
            self.renderer.settings = replace(settings, **changes)
            self.request_redraw()

    def open(self, path: str | os.PathLike[str]) -> None:
        """Open a model or an environment, as its ending says."""
        suffix = Path(path).suffix.lower()
        if suffix in MODEL_SUFFIXES:
            self.open_model(path)
        elif suffix in ENVIRONMENT_SUFFIXES:
            self.open_environment(path)
        else:
            self.error = (
                f"{path}: neither a model ({', '.join(MODEL_SUFFIXES)}) nor "
                f"an environment ({', '.join(ENVIRONMENT_SUFFIXES)})"
            )

    def open_model(self, source: Any, *, keep_view: bool = False) -> None:
        """Read a model in the background, and show it in place of this one.

        ``keep_view`` leaves the camera where it is.
        """
        self._work.start(
            f"reading {_name(source)}",
            partial(self._read_model, source),
            partial(self._show_model, source, keep_view=keep_view),
        )

    def _read_model(self, source: Any) -> tuple[Model, ModelLayout]:
        """A model whose images are decoded; in the background."""
        model = source
        if not isinstance(source, Model):
            path = asset_folder() / "demo.glb" if source is None else source
            model = load_model(path)
        # The scene finds the layout again as long as somebody holds it.
        begun = self.begun if self.model is None else RenderRequest()
        layout = self.scene.layout_of(
            model,
            model.scene_index(begun.scene),
            model.variant_index(begun.variant),
        )

        def told(done: int, total: int) -> None:
            self._work.tell(
                f"decoding images of {_name(source)}: {done} of {total}"
            )

        self.renderer.preload(layout.primitives, told)
        return model, layout

    def open_environment(self, source: Any) -> None:
        """Read an environment in the background, and light with it."""
        read = partial(load_environment, source)
        if source is None or isinstance(source, Environment):
            read = partial(_identity, source)
        self._work.start(
            f"reading {_name(source)}",
            read,
            partial(self._show_environment, source),
        )

    def frame_everything(self) -> None:
        """Look at the whole model."""
        self._frame(self.scene.bounds())

    def frame_selection(self) -> None:
        """Look at the node that is selected, or else at everything."""
        bounds = None
        if self.model is not None and self.selection is not None:
            bounds = self._bounds_of(self.selection)
        self._frame(self.scene.bounds() if bounds is None else bounds)

    def next_camera(self) -> None:
        """Look through the next camera of the file, if it has any."""
        cameras = self.scene.cameras
        if cameras:
            self._camera_number = (self._camera_number + 1) % len(cameras)
            self.look_through(cameras[self._camera_number])

    def look_through(self, camera: Camera) -> None:
        """Stand where ``camera`` does, free to go on from there."""
        bounds = self.scene.bounds()
        centre = np.zeros(3) if bounds is None else np.mean(bounds, axis=0)
        distance = float(np.linalg.norm(camera.position - centre)) or 1.0
        self.camera.projection = camera.projection
        self.controls.look_from(camera, distance)
        self._look()

    def save_picture(self, path: str | os.PathLike[str]) -> None:
        """Save the next picture, without panels, as .png or .exr."""
        self._wants_picture = Path(path)
        self.request_redraw()

    def tell(self, message: str) -> None:
        """Show a message until something else happens."""
        self.message = message
        self.request_redraw()

    def measure_error(self) -> None:
        """Begin to compare the light of this view with reference lighting."""
        self.measurement = ErrorMeasurement(
            self.renderer, self.scene, self.camera, SAMPLES
        )
        self.request_redraw()

    def request(self) -> RenderRequest:
        """What would render the picture that is seen now."""
        time, animation = 0.0, None
        if self.model is not None and self.model.model.animations:
            current = self.model.animations.current
            if current is not None:
                time, animation = current.time, current.animation
        return replace(
            self.begun,
            source=self.model_source,
            environment=self.environment_source,
            environment_rotation=self.scene.environment_rotation,
            environment_intensity=self.scene.environment_intensity,
            background=self.scene.background,
            background_blur=self.scene.background_blur,
            camera=look_text(self.controls.look(self.camera)),
            size=self.size,
            settings=self.settings,
            time=time,
            animation=animation,
            variant=None if self.model is None else self.model.variant,
        )

    def command(self) -> str:
        """The ``moka render`` command for :meth:`request`."""
        return command_text(self.request())

    # Events.

    def _press(self, event: KeyEvent) -> None:
        is_control = Modifiers.CONTROL in event.modifiers
        match event.key:
            case Key.ESCAPE:
                self.quit()
            case Key.F1:
                self.shows_help = not self.shows_help
            case Key.F11 if self.window is not None:
                self.window.fullscreen = not self.window.fullscreen
            case Key.F12:
                self.save_picture(unused_path(Path("moka.png")))
            case Key.SPACE:
                toggle_playing(self)
            case Key.TAB | Key.H:
                self.shows_panels = not self.shows_panels
            case Key.C if is_control and self.window is not None:
                self.window.clipboard = self.command()
                self.tell("copied: moka render ...")
            case Key.R:
                self.auto_rotates = not self.auto_rotates
            case Key.C:
                self.next_camera()
            case Key.F:
                self.frame_selection()
            case Key.HOME:
                self.frame_everything()

    def _click(self, event: MouseButtonEvent) -> None:
        self.comparison.is_dragged = False
        if event.pressed:
            self.message = None
            is_ours = not self.interface.wants_pointer
            if is_ours and self.comparison.take(event.x, self._area()[0]):
                return
            self._pressed_at = (event.x, event.y) if is_ours else None
            return
        pressed, self._pressed_at = self._pressed_at, None
        if pressed is None or math.dist(pressed, (event.x, event.y)) > _CLICK:
            return
        if event.button is MouseButton.LEFT:
            now = perf_counter()
            is_double = now - self._clicked < _DOUBLE_CLICK
            self._clicked = 0.0 if is_double else now
            self._wants_pick = (event.x, event.y), is_double

    def _drag(self, event: MouseMoveEvent) -> None:
        mouse = self.input.mouse
        height = self._window_size()[1]
        across, down = event.dx / height, event.dy / height
        if self.comparison.is_dragged:
            self.comparison.drag(event.x, self._area()[0])
        elif mouse.is_down(MouseButton.LEFT):
            self.controls.orbit(across, down)
        elif mouse.is_down(MouseButton.RIGHT) or mouse.is_down(
            MouseButton.MIDDLE
        ):
            self.controls.pan(across, down, self.camera)
        else:
            return
        self._look()

    def _fly(self, seconds: float) -> None:
        keyboard = self.input.keyboard
        if self.interface.wants_keyboard or Modifiers.CONTROL in (
            keyboard.modifiers
        ):
            return

        def held(positive: Key, negative: Key) -> float:
            return keyboard.is_down(positive) - keyboard.is_down(negative)

        way = np.array(
            [held(Key.D, Key.A), held(Key.E, Key.Q), held(Key.W, Key.S)]
        )
        if not way.any():
            return
        # The first frame after a rest is no second long.
        step = _FLIGHT * min(seconds, 0.1)
        if Modifiers.SHIFT in keyboard.modifiers:
            step *= 4.0
        self.controls.fly(*(step * way))
        self._look()
        self.request_redraw()

    # The camera.

    def _look(self) -> None:
        self.controls.apply(self.camera)
        self.draft.note_motion()
        self.request_redraw()

    def _frame(self, bounds: Any) -> None:
        width, height = self.size
        self.controls.frame(bounds, self.camera, width / height)
        self._look()

    def _pointer(self) -> tuple[float, float]:
        """Where it is, from the middle in halves of the window's height."""
        x, y = self.input.mouse.position
        width, height = self._window_size()
        width -= self._column_width()
        return (2 * x - width) / height, (height - 2 * y) / height

    def _window_size(self) -> tuple[int, int]:
        """In its own coordinates, which are those of events and panels."""
        width, height = self.window.size if self.window else self.size
        return max(width, 1), max(height, 1)

    def _area(self) -> tuple[int, int]:
        """What the picture takes of the window."""
        width, height = self._window_size()
        return width - self._column_width(), height

    def _column_width(self) -> int:
        """What the panels take of the window's width."""
        if not self.shows_panels:
            return 0
        return min(
            round(_COLUMN * self.interface.scale), self._window_size()[0] // 2
        )

    def _picture_size(
        self, window: tuple[int, int], pixels: tuple[int, int]
    ) -> tuple[int, int]:
        """Pixels of the picture, which is beside the panels."""
        part = 1.0 - self._column_width() / window[0]
        return max(round(pixels[0] * part), 1), max(pixels[1], 1)

    # What the background has done.

    def _show_model(
        self, source: Any, read: tuple[Model, ModelLayout], *, keep_view: bool
    ) -> None:
        model, _ = read
        is_first = self.model is None
        self._remove_model()
        begun = self.begun
        self.model = self.scene.add(
            model,
            scene=begun.scene if is_first else None,
            variant=begun.variant if is_first else None,
        )
        if self.model.model.animations:
            if is_first and (begun.time or begun.animation is not None):
                self.model.animations.pose(begun.animation or 0, begun.time)
            else:
                self.model.animations.play()
        self.model_source = source
        if _is_path(source):
            self.preferences = replace(
                self.preferences,
                recent_models=with_recent(
                    self.preferences.recent_models, source
                ),
            )
        self.selection = None
        self.error = None
        self._watch()
        self._camera_number = -1
        if self.window is not None:
            self.window.set_title(f"{_name(source)} - moka")
        if keep_view:
            return
        width, height = self.size
        choice = begun.camera if is_first else None
        if isinstance(choice, str):
            choice = parse_camera(choice)
        if isinstance(choice, Look):
            self._look_as(choice)
            return
        if isinstance(choice, Orbit) or (
            choice is None and not self.scene.cameras
        ):
            self._orbit(choice or Orbit(self.controls.yaw, self.controls.pitch))
            return
        if not isinstance(choice, Camera):
            choice = choose_camera(self.scene, choice, width / height)
        self.look_through(choice)

    def _look_as(self, look: Look) -> None:
        camera = look.camera()
        self.camera.projection = camera.projection
        self.controls.look_from(camera, math.dist(look.eye, look.target))
        self._look()

    def _orbit(self, orbit: Orbit) -> None:
        self.controls.yaw = orbit.yaw
        self.controls.pitch = orbit.pitch
        self.frame_everything()
        if orbit.distance is not None:
            self.controls.distance = orbit.distance
        self._look()

    def _show_environment(
        self, source: Any, environment: Environment | None
    ) -> None:
        self.scene.environment = environment
        self.environment_source = source
        if _is_path(source) and Path(source).exists():
            self.preferences = replace(
                self.preferences,
                recent_environments=with_recent(
                    self.preferences.recent_environments, source
                ),
            )
        self.error = None
        self._watch()
        self.request_redraw()

    # Files that change while they are shown.

    def _watch(self) -> None:
        """Watch the shaders, and the files that are shown."""
        shown = [
            Path(source)
            for source in (self.model_source, self.environment_source)
            if isinstance(source, str | os.PathLike) and Path(source).exists()
        ]
        self._watcher.watch([shader_folder(), *shown])

    def _files_changed(self, paths: frozenset[Path]) -> None:
        """Note it; called on the thread of the watcher."""
        self._changed |= paths
        self.request_redraw()

    def _is_moving(self) -> bool:
        """Whether an animation plays."""
        if self.model is None or not self.model.model.animations:
            return False
        current = self.model.animations.current
        return (
            current is not None
            and current.speed != 0.0
            and self.model.animations.is_playing
        )

    def _reload(self) -> None:
        """Read what has changed again; what is broken stays as it was."""
        changed, self._changed = self._changed, set()
        if not changed:
            return
        if any(path.is_relative_to(shader_folder()) for path in changed):
            try:
                self.renderer.reload_shaders()
                if self.comparison.renderer is not None:
                    self.comparison.renderer.reload_shaders()
                self.error = None
            except MokaError as error:
                self.error = str(error)
        if _is_among(self.model_source, changed):
            self.open_model(self.model_source, keep_view=True)
        if _is_among(self.environment_source, changed):
            self.open_environment(self.environment_source)

    def _chosen(self) -> Preferences:
        """What is to be remembered."""
        settings = self.settings
        source = self.environment_source
        return replace(
            self.preferences,
            size=self._window_size(),
            shows_panels=self.shows_panels,
            open_panels=tuple(
                panel.title for panel in self.panels if panel.is_open
            ),
            environment=_remembered(source),
            environment_intensity=self.scene.environment_intensity,
            background_blur=self.scene.background_blur,
            exposure=settings.exposure,
            tone_map=settings.tone_map,
            gamma=settings.gamma,
            auto_rotates=self.auto_rotates,
        )

    def _remove_model(self) -> None:
        if self.model is not None:
            self.model.remove()
            self.model = None

    def _bounds_of(self, node: int) -> Any:
        assert self.model is not None
        drawables = self.scene.drawables
        row = self.model.rows[node]
        shown = drawables.row == row
        return drawables.bounds(shown) if shown.any() else None

    # Pictures and other things that are read back.

    def _read_picture(self, commands: CommandList) -> None:
        path, self._wants_picture = self._wants_picture, None
        if path is None:
            return
        is_whole = self.renderer.is_complete and not self.draft.is_now
        if self.debug_view is not None or not is_whole:
            # A picture is one of light, and of all of it.
            self._wants_picture = path
            return
        read = self.renderer.read_radiance(commands)
        settings = self.settings

        def save() -> None:
            assert read.data is not None
            image = Image(
                np.ascontiguousarray(read.data[::-1]),
                tone_map=settings.tone_map,
                exposure=settings.exposure,
                gamma=settings.gamma,
            )
            self._work.start(
                f"writing {path}",
                partial(image.save, path),
                lambda _: self.tell(f"saved {path}"),
            )

        self.when_read([read], save)

    def _pick(self, commands: CommandList, window: tuple[int, int]) -> None:
        """Find out what was clicked; twice, and go around it from now on."""
        wanted, self._wants_pick = self._wants_pick, None
        if wanted is None or self.model is None:
            return
        (x, y), is_double = wanted
        size = self.renderer.size
        pixel = (
            int(x / (window[0] - self._column_width()) * size[0]),
            int(y / window[1] * size[1]),
        )
        if not (0 <= pixel[0] < size[0] and 0 <= pixel[1] < size[1]):
            return
        read = begin_pick(
            self.renderer, self.scene, self.camera, pixel, commands
        )

        def then() -> None:
            picked = finish_pick(read, self.camera, pixel, size)
            if picked is None or self.model is None:
                self.selection = None
                return
            nodes = self.model.model.nodes
            self.selection = nodes.row_of_number(picked.number - 1)
            if is_double:
                self.controls.set_pivot(picked.point.tolist())
                self._look()

        self.when_read(list(read.values()), then)

    def when_read(
        self, reads: list[Readback], then: Callable[[], None]
    ) -> None:
        """Do ``then`` when all of ``reads`` have arrived."""
        self._reads.append((reads, then))
        self.request_redraw()

    def _take_reads(self) -> None:
        waiting = self._reads
        self._reads = []
        for reads, then in waiting:
            if all(read.data is not None for read in reads):
                then()
            else:
                self._reads.append((reads, then))

    # The panels.

    def _draw_interface(self, imgui: Any, size: tuple[int, int]) -> None:
        if self.model is not None and self.selection is not None:
            box = self._bounds_of(self.selection)
            if box is not None:
                draw_box(imgui, box, self.camera, self._area())
        if self.debug_view is None:
            here = f"{self.settings.ibl}, {self.settings.brdf}"
            self.comparison.draw_divider(imgui, self._area(), here)
        if self.shows_panels:
            self._draw_column(imgui, size)
            draw_timeline(imgui, self, self._area())
        self.shows_help = draw_help(imgui, is_open=self.shows_help)
        self._draw_state(imgui, size)

    def _draw_column(self, imgui: Any, size: tuple[int, int]) -> None:
        width = self._column_width()
        imgui.set_next_window_pos((size[0] - width, 0))
        imgui.set_next_window_size((width, size[1]))
        flags = imgui.WindowFlags_
        imgui.begin("moka", None, flags.no_decoration | flags.no_move)
        imgui.push_item_width(-0.35 * width)
        for panel in self.panels:
            if not panel.is_useful(self):
                continue
            opened = (
                imgui.TreeNodeFlags_.default_open if panel.starts_open else 0
            )
            panel.is_open = imgui.collapsing_header(panel.title, opened)
            if panel.is_open:
                imgui.push_id(panel.title)
                panel.draw(imgui, self)
                imgui.pop_id()
        imgui.pop_item_width()
        imgui.end()

    def _draw_state(self, imgui: Any, size: tuple[int, int]) -> None:
        """What is being done, and what went wrong, at the lower left."""
        doing = self._work.doing
        if doing is None and self.error is None and self.message is None:
            return
        imgui.set_next_window_pos((8, size[1] - 8), pivot=(0, 1))
        flags = imgui.WindowFlags_
        imgui.begin(
            "state",
            None,
            flags.no_decoration | flags.always_auto_resize | flags.no_move,
        )
        if doing is not None:
            imgui.text(f"{doing} ...")
        elif self.message is not None:
            imgui.text(self.message)
        if self.error is not None:
            imgui.push_text_wrap_pos(0.6 * size[0])
            imgui.text_colored((1.0, 0.5, 0.4, 1.0), self.error)
            imgui.pop_text_wrap_pos()
            if imgui.small_button("dismiss"):
                self.error = None
        imgui.end()


def _name(source: Any) -> str:
    if isinstance(source, str | os.PathLike):
        return Path(source).name
    return "the demo scene" if source is None else "a model"


def _is_path(source: Any) -> bool:
    return isinstance(source, str | os.PathLike)


def _remembered(source: Any) -> str:
    """How an environment is found again from any folder."""
    if not _is_path(source):
        return Preferences().environment
    path = Path(source)
    return str(path.absolute() if path.is_file() else source)


def _is_among(source: Any, changed: set[Path]) -> bool:
    return _is_path(source) and Path(source).resolve() in changed


def _identity(value: Any) -> Any:
    return value
