"""What keys and the pointer do outside of the panels."""

import math
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from moka.app.events import (
    Event,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ScrollEvent,
)
from moka.app.keys import Key, Modifiers, MouseButton
from moka.ui.panels.output import unused_path
from moka.ui.panels.timeline import toggle_playing
from moka.ui.picture_command import copy_command

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["Gestures"]

# A drag is not a click when the pointer has moved by more than this.
_CLICK = 4.0

# Seconds within which a second click makes a double click.
_DOUBLE_CLICK = 0.4

# Distances to the target per second of flight.
_FLIGHT = 1.0

# Of the window's height, a second; half a turn is the height.
_ROTATION = 0.2 / math.pi


class Gestures:
    """Moves the camera of a viewer, and does what its keys stand for."""

    def __init__(self, viewer: "Viewer") -> None:
        self._viewer = viewer
        self._pressed_at: tuple[float, float] | None = None
        self._clicked = 0.0

    def take(self, event: Event) -> None:
        """Do what an event stands for, unless a panel wants it."""
        viewer = self._viewer
        interface = viewer.interface
        match event:
            case KeyEvent(pressed=True) if not interface.wants_keyboard:
                self._press(event)
            case MouseButtonEvent():
                self._click(event)
            case MouseMoveEvent() if not interface.wants_pointer:
                self._drag(event)
            case ScrollEvent(dy=clicks) if not interface.wants_pointer:
                viewer.controls.zoom(clicks, viewer.camera, self._pointer())
                viewer.viewpoint.follow()

    def advance(self, seconds: float) -> None:
        """Go on with what moves as long as time passes."""
        self._fly(seconds)
        viewer = self._viewer
        if viewer.auto_rotates and not self._pressed_at:
            viewer.controls.orbit(-_ROTATION * seconds, 0.0)
            viewer.viewpoint.follow()

    def _press(self, event: KeyEvent) -> None:
        viewer = self._viewer
        is_control = Modifiers.CONTROL in event.modifiers
        match event.key:
            case Key.ESCAPE:
                viewer.quit()
            case Key.F1:
                viewer.shows_help = not viewer.shows_help
            case Key.F11 if viewer.window is not None:
                viewer.window.fullscreen = not viewer.window.fullscreen
            case Key.F12:
                viewer.save_picture(unused_path(Path("moka.png")))
            case Key.SPACE:
                toggle_playing(viewer)
            case Key.TAB | Key.H:
                viewer.shows_panels = not viewer.shows_panels
            case Key.C if is_control:
                copy_command(viewer)
            case Key.R:
                viewer.auto_rotates = not viewer.auto_rotates
            case Key.C:
                viewer.viewpoint.next_camera()
            case Key.F:
                viewer.viewpoint.frame_selection()
            case Key.HOME:
                viewer.viewpoint.frame_everything()

    def _click(self, event: MouseButtonEvent) -> None:
        viewer = self._viewer
        viewer.comparison.is_dragged = False
        if event.pressed:
            viewer.message = None
            is_ours = not viewer.interface.wants_pointer
            if is_ours and viewer.comparison.take(event.x, viewer.area[0]):
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
            viewer.readbacks.pick((event.x, event.y), is_double=is_double)

    def _drag(self, event: MouseMoveEvent) -> None:
        viewer = self._viewer
        mouse = viewer.input.mouse
        height = viewer.window_size[1]
        across, down = event.dx / height, event.dy / height
        if viewer.comparison.is_dragged:
            viewer.comparison.drag(event.x, viewer.area[0])
        elif mouse.is_down(MouseButton.LEFT):
            viewer.controls.orbit(across, down)
        elif mouse.is_down(MouseButton.RIGHT) or mouse.is_down(
            MouseButton.MIDDLE
        ):
            viewer.controls.pan(across, down, viewer.camera)
        else:
            return
        viewer.viewpoint.follow()

    def _fly(self, seconds: float) -> None:
        viewer = self._viewer
        keyboard = viewer.input.keyboard
        if viewer.interface.wants_keyboard or Modifiers.CONTROL in (
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
        viewer.controls.fly(*(step * way))
        viewer.viewpoint.follow()
        viewer.request_redraw()

    def _pointer(self) -> tuple[float, float]:
        """Where it is, from the middle in halves of the window's height."""
        viewer = self._viewer
        x, y = viewer.input.mouse.position
        width, height = viewer.window_size
        width -= viewer.column_width
        return (2 * x - width) / height, (height - 2 * y) / height
