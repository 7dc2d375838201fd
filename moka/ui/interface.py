"""A Dear ImGui context that lives on moka's events and draws by its list."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from moka.app.events import (
    Event,
    FocusEvent,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ScrollEvent,
    TextEvent,
)
from moka.app.keys import Key, Modifiers, MouseButton
from moka.commands.command_list import CommandList
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.core.errors import MokaError
from moka.graphics.device import GraphicsDevice
from moka.ui.interface_pass import InterfacePass
from moka.ui.style import apply_style

__all__ = ["Interface"]

_BUTTONS = {
    MouseButton.LEFT: 0,
    MouseButton.RIGHT: 1,
    MouseButton.MIDDLE: 2,
    MouseButton.BUTTON_4: 3,
    MouseButton.BUTTON_5: 4,
}


class Interface:
    """The panels of one window.

    Feed it what happens to the window (:meth:`take`), say what there is to
    see between :meth:`frame` and its end, and :meth:`draw`. ``scale`` is by
    how much text and buttons are enlarged. Raises MokaError if imgui-bundle
    is not installed.
    """

    def __init__(self, device: GraphicsDevice, scale: float = 1.0) -> None:
        try:
            from imgui_bundle import imgui
        except ImportError as error:
            raise MokaError(
                "panels need imgui-bundle: pip install 'moka-pbr[window]'"
            ) from error
        self._imgui = imgui
        self._context: Any = imgui.create_context()
        imgui.set_current_context(self._context)
        io = imgui.get_io()
        # Where panels stand is a preference of ours, not a file of its own.
        io.set_ini_filename("")
        io.config_flags |= imgui.ConfigFlags_.nav_enable_keyboard
        io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        io.backend_flags |= imgui.BackendFlags_.renderer_has_vtx_offset
        apply_style(imgui, scale)
        self.scale = scale
        self._pass = InterfacePass(device)
        self._draw_data: Any = None

    def close(self) -> None:
        """Forget the context; what it drew with goes with the device."""
        if self._context is not None:
            self._imgui.destroy_context(self._context)
            self._context = None

    @property
    def wants_pointer(self) -> bool:
        """Whether the pointer is over a panel, or drags something of it."""
        return bool(self._io.want_capture_mouse)

    @property
    def wants_keyboard(self) -> bool:
        """Whether what is typed belongs to a panel."""
        return bool(self._io.want_text_input)

    def take(self, event: Event) -> None:
        """Tell the panels what has happened to the window."""
        imgui, io = self._imgui, self._io
        match event:
            case MouseMoveEvent(x, y):
                io.add_mouse_pos_event(x, y)
            case MouseButtonEvent(button, pressed, x, y, modifiers):
                self._take_modifiers(modifiers)
                io.add_mouse_pos_event(x, y)
                if button in _BUTTONS:
                    io.add_mouse_button_event(_BUTTONS[button], pressed)
            case ScrollEvent(dx, dy):
                io.add_mouse_wheel_event(dx, dy)
            case KeyEvent(key, pressed, _, modifiers):
                self._take_modifiers(modifiers)
                known = _keys().get(key)
                if known is not None:
                    io.add_key_event(imgui.Key(known), pressed)
            case TextEvent(text):
                io.add_input_characters_utf8(text)
            case FocusEvent(focused):
                io.add_focus_event(focused)

    @contextmanager
    def frame(self, size: tuple[int, int], delta: float) -> Iterator[Any]:
        """Say what there is to see; gives the module ``imgui``.

        ``size`` is the window's in its own coordinates, ``delta`` seconds
        have passed since the last frame. If the block raises, nothing of it
        is seen.
        """
        imgui, io = self._imgui, self._io
        io.display_size = imgui.ImVec2(*size)
        io.delta_time = max(delta, 1e-4)
        imgui.new_frame()
        try:
            yield imgui
        except BaseException:
            imgui.end_frame()
            raise
        imgui.render()
        self._draw_data = imgui.get_draw_data()

    def draw(
        self,
        commands: CommandList,
        key: SortKey,
        framebuffer: Handle | None,
        size: tuple[int, int],
    ) -> int:
        """Record the panels of the last :meth:`frame`; returns its draws.

        ``size`` is the framebuffer's in pixels; None is the window.
        """
        if self._draw_data is None:
            return 0
        return self._pass.draw(
            self._draw_data, commands, key, framebuffer, size
        )

    @property
    def _io(self) -> Any:
        self._imgui.set_current_context(self._context)
        return self._imgui.get_io()

    def _take_modifiers(self, held: Modifiers) -> None:
        key = self._imgui.Key
        for modifier, known in (
            (Modifiers.SHIFT, key.mod_shift),
            (Modifiers.CONTROL, key.mod_ctrl),
            (Modifiers.ALT, key.mod_alt),
            (Modifiers.SUPER, key.mod_super),
        ):
            self._io.add_key_event(known, modifier in held)


@cache
def _keys() -> dict[Key, int]:
    """Dear ImGui's numbers of our keys."""
    from imgui_bundle import imgui

    names = {key: _imgui_name(key) for key in Key}
    return {
        key: getattr(imgui.Key, name).value
        for key, name in names.items()
        if hasattr(imgui.Key, name)
    }


def _imgui_name(key: Key) -> str:
    name = key.name.lower()
    if key in (Key.UP, Key.DOWN, Key.LEFT, Key.RIGHT):
        return f"{name}_arrow"
    name = name.replace("digit_", "_").replace("control", "ctrl")
    return re.sub(r"keypad_(?=[0-9])", "keypad", name)
