"""What events add up to."""

from moka.app.events import (
    FocusEvent,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ScrollEvent,
    TextEvent,
)
from moka.app.input import Gamepad, Input
from moka.app.keys import (
    GamepadAxis,
    GamepadButton,
    Key,
    Modifiers,
    MouseButton,
)

NONE = Modifiers.NONE


def test_a_key_is_pressed_once_held_and_released_once() -> None:
    state = Input()
    keyboard = state.keyboard
    state.take(KeyEvent(Key.W, True, False, Modifiers.SHIFT))
    assert keyboard.was_pressed(Key.W)
    assert keyboard.is_down(Key.W)
    assert keyboard.modifiers is Modifiers.SHIFT
    state.forget_changes()
    state.take(KeyEvent(Key.W, True, True, NONE))
    assert not keyboard.was_pressed(Key.W)
    assert keyboard.is_down(Key.W)
    state.take(KeyEvent(Key.W, False, False, NONE))
    assert keyboard.was_released(Key.W)
    assert keyboard.is_up(Key.W)
    state.forget_changes()
    assert not keyboard.was_released(Key.W)


def test_a_tap_between_two_updates_is_not_lost() -> None:
    state = Input()
    state.take(KeyEvent(Key.SPACE, True, False, NONE))
    state.take(KeyEvent(Key.SPACE, False, False, NONE))
    assert state.keyboard.was_pressed(Key.SPACE)
    assert not state.keyboard.is_down(Key.SPACE)


def test_motion_scroll_and_text_add_up() -> None:
    state = Input()
    for event in (
        MouseMoveEvent(3, 4, 3, 4),
        MouseMoveEvent(5, 3, 2, -1),
        ScrollEvent(0, 1),
        ScrollEvent(0.5, 1),
        TextEvent("a"),
        TextEvent("b"),
    ):
        state.take(event)
    assert state.mouse.position == (5, 3)
    assert state.mouse.motion == (5, 3)
    assert state.mouse.scroll == (0.5, 2)
    assert state.keyboard.text == "ab"
    state.forget_changes()
    assert state.mouse.position == (5, 3)
    assert state.mouse.motion == state.mouse.scroll == (0, 0)
    assert state.keyboard.text == ""


def test_nothing_stays_held_when_the_window_loses_the_keyboard() -> None:
    state = Input()
    state.take(KeyEvent(Key.W, True, False, NONE))
    state.take(MouseButtonEvent(MouseButton.LEFT, True, 1, 2, NONE))
    assert state.mouse.is_down(MouseButton.LEFT)
    state.forget_changes()
    state.take(FocusEvent(False))
    assert state.keyboard.was_released(Key.W)
    assert state.mouse.was_released(MouseButton.LEFT)
    assert not state.keyboard.down
    assert not state.mouse.down


def test_a_stick_near_its_middle_is_in_its_middle() -> None:
    pad = Gamepad(
        "pad",
        frozenset({GamepadButton.SOUTH}),
        {GamepadAxis.LEFT_X: 0.05, GamepadAxis.LEFT_Y: -0.5},
    )
    assert pad.is_down(GamepadButton.SOUTH)
    assert pad.axis(GamepadAxis.LEFT_X) == 0.0
    assert pad.axis(GamepadAxis.LEFT_Y) == -0.5
    assert pad.axis(GamepadAxis.RIGHT_X) == 0.0
