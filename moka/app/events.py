"""What happens to a window, as plain values.

Positions and motion are in the window's own coordinates: the origin is the
upper left corner of its content, x to the right and y down. They are
multiples of a pixel where the display is scaled.
"""

from dataclasses import dataclass

from moka.app.keys import Key, Modifiers, MouseButton

__all__ = [
    "CloseEvent",
    "DropEvent",
    "Event",
    "FocusEvent",
    "KeyEvent",
    "MouseButtonEvent",
    "MouseMoveEvent",
    "ResizeEvent",
    "ScrollEvent",
    "TextEvent",
]


@dataclass(frozen=True, slots=True)
class CloseEvent:
    """A person asked for the window to be closed."""


@dataclass(frozen=True, slots=True)
class ResizeEvent:
    """The framebuffer has a new size in pixels; zero when minimised."""

    width: int
    height: int


@dataclass(frozen=True, slots=True)
class FocusEvent:
    """The window begins, or ceases, to get what is typed."""

    focused: bool


@dataclass(frozen=True, slots=True)
class DropEvent:
    """Files were dragged into the window and dropped there."""

    paths: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class KeyEvent:
    """A key went down or up; ``repeated`` when it is being held."""

    key: Key
    pressed: bool
    repeated: bool
    modifiers: Modifiers


@dataclass(frozen=True, slots=True)
class TextEvent:
    """A character was typed."""

    text: str


@dataclass(frozen=True, slots=True)
class MouseMoveEvent:
    """The pointer is at ``x``, ``y`` and moved by ``dx``, ``dy``."""

    x: float
    y: float
    dx: float
    dy: float


@dataclass(frozen=True, slots=True)
class MouseButtonEvent:
    """A mouse button went down or up at ``x``, ``y``."""

    button: MouseButton
    pressed: bool
    x: float
    y: float
    modifiers: Modifiers


@dataclass(frozen=True, slots=True)
class ScrollEvent:
    """The wheel turned: ``dy`` is positive away from the person."""

    dx: float
    dy: float


Event = (
    CloseEvent
    | DropEvent
    | FocusEvent
    | KeyEvent
    | MouseButtonEvent
    | MouseMoveEvent
    | ResizeEvent
    | ScrollEvent
    | TextEvent
)
