"""The viewer: a model in a window, and panels to look into it.

It draws on demand. Whatever takes long (reading a file, writing a picture)
is done in the background while the window answers; what goes wrong there is
told in the window, and the picture stays as it was.

Here is its state, and what it does in each frame. Files that are opened are
in :mod:`moka.ui.opened_files`, keys and the pointer in
:mod:`moka.ui.gestures`, where the camera goes in :mod:`moka.ui.viewpoint`,
how the picture is made in :mod:`moka.ui.choices`,
what is read back from the GPU in :mod:`moka.ui.readbacks`, where panels stand
in :mod:`moka.ui.layout`, and the command of what is seen in
:mod:`moka.ui.picture_command`.
"""

import os
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

from moka.app.application import App, GameTime
from moka.app.events import (
    DropEvent,
    Event,
    KeyEvent,
    MouseButtonEvent,
    TextEvent,
)
from moka.app.render_request import RenderRequest
from moka.commands.command_list import CommandList
from moka.commands.commands import Timestamps
from moka.commands.sort_key import SortKey
from moka.core.errors import MokaError
from moka.renderer.settings import RenderSettings
from moka.scene.lights import Light
from moka.scene.scene_model import SceneModel
from moka.ui.background_work import BackgroundWork
from moka.ui.choices import Choices
from moka.ui.comparison import Comparison
from moka.ui.draft import Draft
from moka.ui.frame_times import PASS_INTERFACE, FrameTimes, mark_passes
from moka.ui.gestures import Gestures
from moka.ui.interface import Interface
from moka.ui.layout import column_width, draw_interface
from moka.ui.lighting_error import SAMPLES, ErrorMeasurement
from moka.ui.opened_files import OpenedFiles
from moka.ui.orbit_controls import OrbitControls
from moka.ui.panels.all_panels import all_panels
from moka.ui.preferences import Preferences, save_preferences
from moka.ui.readbacks import Readbacks
from moka.ui.viewpoint import Viewpoint

__all__ = ["Viewer"]

# Panels follow the pointer a frame later, and sizes of text one more.
_FRAMES_TO_SETTLE = 3
_MOST_FRAMES_TO_SETTLE = 100


class Viewer(App):
    """Shows what ``request`` describes, and lets a person change it all.

    ``controls`` move the camera; ``model`` is what is open, None before it
    has been read; ``selection`` the row of a node of it. ``debug_view`` is
    a name of :data:`moka.renderer.debug_view.DEBUG_VIEWS` or None. ``error``
    is the last thing that went wrong, ``message`` what else to tell a person.
    ``comparison`` is what stands beside the picture, ``measurement`` the last
    one of the light's error, ``times`` where the time of frames goes,
    ``added_lights`` those that are no file's, ``edits`` what of the file was
    changed, as a person is told.

    What is chosen is saved at the end if ``preferences`` are given.
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
        self.selection: int | None = None
        self.error: str | None = None
        self.message: str | None = None
        self.debug_view: str | None = None
        self.shows_panels = self.preferences.shows_panels
        self.shows_help = False
        self.auto_rotates = self.preferences.auto_rotates
        self.added_lights: list[Light] = []
        self.edits: set[str] = set()
        self.interface: Interface
        self.panels = all_panels()
        opened = self.preferences.open_panels
        for panel in self.panels:
            if opened is not None:
                panel.starts_open = panel.title in opened
            panel.is_open = panel.starts_open
        self.times = FrameTimes()
        self.draft = Draft()
        self.comparison = Comparison()
        self.measurement: ErrorMeasurement | None = None
        self.work = BackgroundWork(self.request_redraw)
        self.files = OpenedFiles(self)
        self.viewpoint = Viewpoint(self)
        self.choices = Choices(self)
        self.gestures = Gestures(self)
        self.readbacks = Readbacks(self)
        self._settling = 0
        self._updating = 0.0

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
        self.open_environment(begun.environment)
        self.open_model(begun.source)

    def event(self, event: Event) -> None:
        """Panels first; what they do not want moves the camera."""
        self._settling = max(self._settling, _FRAMES_TO_SETTLE)
        if isinstance(event, KeyEvent | MouseButtonEvent | TextEvent):
            # Dear ImGui takes a press and its release in two frames.
            self._settling = min(self._settling + 1, _MOST_FRAMES_TO_SETTLE)
        self.interface.take(event)
        if isinstance(event, KeyEvent | MouseButtonEvent) and event.pressed:
            self.message = None  # It has been read.
        if isinstance(event, DropEvent):
            for path in event.paths:
                self.open(path)
        else:
            self.gestures.take(event)

    def update(self, time: GameTime) -> None:
        """Take over what the background has done, and move on."""
        start = perf_counter()
        try:
            self.work.poll()
            if self.measurement is not None:
                self.measurement.step()
        except MokaError as error:
            self.error = str(error)
            if self.measurement and not self.measurement.is_done:
                self.measurement = None
        self.files.reload()
        self.readbacks.take()
        self.gestures.advance(time.delta)
        if self.is_animating:
            self.draft.note_motion()
        self._settling = max(self._settling - 1, 0)
        if self._goes_on():
            self.request_redraw()
        self._updating = perf_counter() - start

    def draw(self, time: GameTime, commands: CommandList) -> None:
        """The scene, then the panels over it."""
        size = self.window_size
        pixels = self.window.framebuffer_size if self.window else self.size
        self.renderer.size = self._picture_size(size, pixels)
        self.times.add("wait", self.waited)
        self.draft.note_wait(self.waited)
        places = self.times.begin_frame()
        self.readbacks.begin_frame()
        self.times.add("update", self._updating)
        with self.times.stage("scene"):
            if places:
                mark_passes(commands, places[0])
            self._draw_picture(commands, places[1] if places else None)
            self.readbacks.record(commands)
        with (
            self.times.stage("panels"),
            self.interface.frame(size, time.delta) as imgui,
        ):
            draw_interface(self, imgui, size)
        with self.times.stage("draw panels"):
            self.interface.draw(commands, SortKey(PASS_INTERFACE), None, pixels)

    def close(self) -> None:
        """End the work in the background."""
        self.files.close()
        self.work.close()
        if self._remembers:
            save_preferences(self.choices.remembered())
        for panel in self.panels:
            panel.close()
        self.interface.close()

    def _goes_on(self) -> bool:
        """Whether the next frame will show something else."""
        is_measuring = self.measurement and not (
            self.measurement.is_done or self.measurement.waits
        )
        compares = self.debug_view is None and not self.comparison.is_complete
        # After motion the picture is made once more, as it should be.
        return bool(
            self._settling
            or self.readbacks.are_pending
            or is_measuring
            or compares
            or self.draft.is_moving
        )

    @property
    def is_animating(self) -> bool:
        """Whether an animation plays."""
        if self.model is None or not self.model.model.animations:
            return False
        current = self.model.animations.current
        return (
            current is not None
            and current.speed != 0.0
            and self.model.animations.is_playing
        )

    def _draw_picture(
        self, commands: CommandList, times: Timestamps | None
    ) -> None:
        settings = self.renderer.settings
        self.renderer.settings = self.draft.settings(settings)
        try:
            if self.debug_view is None and self.window is not None:
                self.comparison.draw(
                    self.renderer, self.scene, self.camera, times
                )
                if self.readbacks.saves_picture:
                    # All of it, over the other one for a moment.
                    self.renderer.area = None
            self._draw_scene(commands)
        except MokaError as error:
            self.error = str(error)
            self.remove_model()
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

    @property
    def environment_source(self) -> Any:
        """What lights: a path, a built-in name, or what else was given."""
        return self.files.environment_source

    def open(self, path: str | os.PathLike[str]) -> None:
        """Open a model or an environment, as its ending says."""
        self.files.open(path)

    def open_model(self, source: Any) -> None:
        """Read a model in the background, and show it in place of this one."""
        self.files.open_model(source)

    def open_environment(self, source: Any) -> None:
        """Read an environment in the background, and light with it."""
        self.files.open_environment(source)

    def save_picture(self, path: str | os.PathLike[str]) -> None:
        """Save the next picture, without panels, as .png or .exr."""
        self.readbacks.save_picture(Path(path))
        self.request_redraw()

    def tell(self, message: str) -> None:
        """Show a message until a person presses something."""
        self.message = message
        self.request_redraw()

    def measure_error(self) -> None:
        """Begin to compare the light of this view with reference lighting."""
        measurement = ErrorMeasurement(
            self.renderer, self.scene, self.camera, SAMPLES
        )

        def told(done: int, total: int) -> None:
            self.work.tell(f"preparing the light: {100 * done // total} %")

        def begin(_: None) -> None:
            measurement.waits = False
            self.request_redraw()

        measurement.waits = True
        self.measurement = measurement
        self.work.start(
            "preparing the light", partial(measurement.prepare, told), begin
        )
        self.request_redraw()

    def remove_model(self) -> None:
        """Take the model that is open out of the scene, if there is one."""
        if self.model is not None:
            self.model.remove()
            self.model = None

    @property
    def selected_bounds(self) -> Any:
        """The world box (2, 3) of what is selected; None if it is empty."""
        if self.model is None or self.selection is None:
            return None
        drawables = self.scene.drawables
        return drawables.bounds(
            drawables.row == self.model.rows[self.selection]
        )

    # The window.

    @property
    def window_size(self) -> tuple[int, int]:
        """In its own coordinates, which are those of events and panels."""
        width, height = self.window.size if self.window else self.size
        return max(width, 1), max(height, 1)

    @property
    def area(self) -> tuple[int, int]:
        """What the picture takes of the window."""
        width, height = self.window_size
        return width - self.column_width, height

    @property
    def column_width(self) -> int:
        """What the panels take of the window's width."""
        if not self.shows_panels:
            return 0
        return column_width(self.window_size[0], self.interface.scale)

    def _picture_size(
        self, window: tuple[int, int], pixels: tuple[int, int]
    ) -> tuple[int, int]:
        """Pixels of the picture, which is beside the panels."""
        part = 1.0 - self.column_width / window[0]
        return max(round(pixels[0] * part), 1), max(pixels[1], 1)
