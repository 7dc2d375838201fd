"""Gamepads, with the layout that GLFW's database of them knows."""

from typing import Any

from moka.app.input import Gamepad
from moka.app.keys import GamepadAxis, GamepadButton

__all__ = ["read_gamepads"]

_TRIGGERS = (GamepadAxis.LEFT_TRIGGER, GamepadAxis.RIGHT_TRIGGER)


def read_gamepads(glfw: Any) -> list[Gamepad]:
    """Those that are plugged in now; ``glfw`` is the module, initialised."""
    found = []
    for number in range(glfw.JOYSTICK_LAST + 1):
        if not glfw.joystick_is_gamepad(number):
            continue
        state = glfw.get_gamepad_state(number)
        if state is None:
            continue
        name = glfw.get_gamepad_name(number) or b"gamepad"
        found.append(
            Gamepad(
                name.decode("utf-8", "replace"),
                frozenset(
                    button
                    for button in GamepadButton
                    if state.buttons[button.value]
                ),
                {
                    # Triggers rest at -1.
                    axis: (state.axes[axis.value] + 1) / 2
                    if axis in _TRIGGERS
                    else float(state.axes[axis.value])
                    for axis in GamepadAxis
                },
            )
        )
    return found
