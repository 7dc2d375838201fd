"""What is held, what has just been pressed, and where the pointer is.

Events say what happened; a state says how things are. An :class:`Input` is
the state that the events so far add up to.
"""

from dataclasses import dataclass, field
from typing import Generic, TypeVar

from moka.app.events import (
    Event,
    FocusEvent,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ScrollEvent,
    TextEvent,
)
from moka.app.keys import (
    GamepadAxis,
    GamepadButton,
    Key,
    Modifiers,
    MouseButton,
)

__all__ = ["Gamepad", "Input", "Keyboard", "Mouse"]

Part = TypeVar("Part", Key, MouseButton)


@dataclass
class _Held(Generic[Part]):
    """Keys or buttons between two updates.

    ``down`` are those that are held, ``pressed`` and ``released`` those that
    went down or up since the update before, repeats of a held key aside.
    """

    down: set[Part] = field(default_factory=set)
    pressed: set[Part] = field(default_factory=set)
    released: set[Part] = field(default_factory=set)

    def is_down(self, part: Part) -> bool:
        """Whether it is held."""
        return part in self.down

    def is_up(self, part: Part) -> bool:
        """Whether it is not held."""
        return part not in self.down

    def was_pressed(self, part: Part) -> bool:
        """Whether it went down since the update before."""
        return part in self.pressed

    def was_released(self, part: Part) -> bool:
        """Whether it went up since the update before."""
        return part in self.released

    def press(self, part: Part) -> None:
        """It goes down."""
        self.down.add(part)
        self.pressed.add(part)

    def release(self, *parts: Part) -> None:
        """They go up."""
        self.down.difference_update(parts)
        self.released.update(parts)

    def forget_changes(self) -> None:
        """Nothing has gone up or down since the update that begins."""
        self.pressed.clear()
        self.released.clear()


@dataclass
class Keyboard(_Held[Key]):
    """The keyboard between two updates; ``text`` is what was typed."""

    text: str = ""
    modifiers: Modifiers = Modifiers.NONE


@dataclass
class Mouse(_Held[MouseButton]):
    """The mouse between two updates.

    ``position`` is in the window's coordinates, origin at the upper left, y
    down; ``motion`` and ``scroll`` add up what happened since the update
    before.
    """

    position: tuple[float, float] = (0.0, 0.0)
    motion: tuple[float, float] = (0.0, 0.0)
    scroll: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Gamepad:
    """A gamepad as it is now: the buttons held, and its axes.

    Axes are -1 to 1, triggers 0 to 1; right and down are positive.
    """

    name: str
    buttons: frozenset[GamepadButton] = frozenset()
    axes: dict[GamepadAxis, float] = field(default_factory=dict)

    def is_down(self, button: GamepadButton) -> bool:
        """Whether ``button`` is held."""
        return button in self.buttons

    def axis(self, axis: GamepadAxis, dead_zone: float = 0.1) -> float:
        """Where ``axis`` is; 0 within the ``dead_zone`` around the middle."""
        value = self.axes.get(axis, 0.0)
        return value if abs(value) > dead_zone else 0.0


class Input:
    """``keyboard``, ``mouse`` and ``gamepads`` of a window.

    Between two updates; see :meth:`forget_changes`.
    """

    def __init__(self) -> None:
        self.keyboard = Keyboard()
        self.mouse = Mouse()
        self.gamepads: list[Gamepad] = []

    def take(self, event: Event) -> None:
        """Follow what an event says."""
        keyboard, mouse = self.keyboard, self.mouse
        match event:
            case KeyEvent(key, pressed, repeated, modifiers):
                keyboard.modifiers = modifiers
                if not pressed:
                    keyboard.release(key)
                elif not repeated:
                    keyboard.press(key)
            case TextEvent(text):
                keyboard.text += text
            case MouseMoveEvent(x, y, dx, dy):
                mouse.position = (x, y)
                mouse.motion = (mouse.motion[0] + dx, mouse.motion[1] + dy)
            case MouseButtonEvent(button, pressed, x, y, modifiers):
                keyboard.modifiers = modifiers
                mouse.position = (x, y)
                (mouse.press if pressed else mouse.release)(button)
            case ScrollEvent(dx, dy):
                mouse.scroll = (mouse.scroll[0] + dx, mouse.scroll[1] + dy)
            case FocusEvent(focused=False):
                # Whatever is let go now, somebody else will be told.
                keyboard.release(*keyboard.down)
                mouse.release(*mouse.down)
                keyboard.modifiers = Modifiers.NONE

    def forget_changes(self) -> None:
        """Begin the time until the next update: nothing has changed yet."""
        self.keyboard.forget_changes()
        self.mouse.forget_changes()
        self.keyboard.text = ""
        self.mouse.motion = self.mouse.scroll = (0.0, 0.0)
