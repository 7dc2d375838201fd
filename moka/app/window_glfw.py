"""moderngl-window's window on GLFW, for another thread to draw into.

Imported where a window is opened, and nowhere else.
"""

import sys
import warnings
from collections.abc import Callable
from typing import Any

import glfw

from moka.core.errors import ContextError

with warnings.catch_warnings():
    # moderngl-window imports PyGLM by a name that is to go.
    warnings.simplefilter("ignore", PendingDeprecationWarning)
    from moderngl_window.context.base import BaseWindow
    from moderngl_window.context.glfw.window import Window

__all__ = ["GlfwWindow", "start_glfw"]

_BUTTONS = 8


def start_glfw() -> None:
    """Initialise GLFW; again does no harm. Raises ContextError."""
    # Errors are asked for where they matter and not printed as warnings.
    # One comes with each change to full screen: moderngl-window sets the
    # interval of swaps then, and the context for it is on another thread.
    glfw.ERROR_REPORTING = "log"
    if not glfw.init():
        raise ContextError(
            f"no window can be opened: {_last_error()}; run with a "
            "display, for instance under xvfb-run, or headless"
        )


class GlfwWindow(Window):
    """A window whose OpenGL context is current nowhere when it opens.

    Callbacks go to the ``..._func`` properties of moderngl-window. Added are
    those that it has none for on GLFW: focus, dropped files, fractions of
    pixels, all modifiers, buttons beyond three. No callback may raise: the
    binding of GLFW keeps an exception in one place for all threads, and the
    render thread could be hit by it.

    The opening itself is not inherited. The constructor there makes the
    context current and wraps it with ModernGL on the thread that opens the
    window, asks for depth and stencil bits, cannot ask for a debug context,
    and ends GLFW with every other window if this one cannot be opened.
    Raises ContextError.
    """

    _mouse_button_map = {code: code + 1 for code in range(_BUTTONS)}  # noqa: RUF012

    def __init__(
        self,
        title: str,
        size: tuple[int, int],
        *,
        resizable: bool,
        visible: bool,
        vsync: bool,
        debug: bool,
    ) -> None:
        BaseWindow.__init__(
            self,
            title=title,
            size=size,
            resizable=resizable,
            visible=visible,
            vsync=vsync,
        )
        # Which keys do what is the application's affair.
        self.exit_key = self.fullscreen_key = None
        self.focus_func: Callable[[bool], None] = lambda _: None
        self.pointer_func: Callable[[float, float, float, float], None]
        self.pointer_func = lambda *_: None
        self.held = 0
        self._pointer: tuple[float, float] | None = None
        glfw.default_window_hints()
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, self.gl_version[0]),
            (glfw.CONTEXT_VERSION_MINOR, self.gl_version[1]),
            (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
            (glfw.OPENGL_FORWARD_COMPAT, sys.platform == "darwin"),
            (glfw.OPENGL_DEBUG_CONTEXT, debug),
            (glfw.RESIZABLE, resizable),
            (glfw.VISIBLE, visible),
            # Pictures arrive finished from framebuffers of the renderer.
            (glfw.DEPTH_BITS, 0),
            (glfw.STENCIL_BITS, 0),
        ):
            glfw.window_hint(hint, value)
        self._window = glfw.create_window(*self.size, title, None, None)
        if not self._window:
            raise ContextError(f"no window can be opened: {_last_error()}")
        self._buffer_width, self._buffer_height = glfw.get_framebuffer_size(
            self._window
        )
        self._listen()

    @property
    def handle(self) -> Any:
        """The window as GLFW knows it."""
        return self._window

    def set_default_viewport(self) -> None:
        """Nothing: the render thread sets the viewport of each pass."""

    def destroy(self) -> None:
        """Close this window and, unlike there, no other one."""
        glfw.destroy_window(self._window)

    def _listen(self) -> None:
        window = self._window
        glfw.set_key_callback(window, self.glfw_key_event_callback)
        glfw.set_char_callback(window, self.glfw_char_callback)
        glfw.set_cursor_pos_callback(window, self.glfw_mouse_event_callback)
        glfw.set_mouse_button_callback(window, self.glfw_mouse_button_callback)
        glfw.set_scroll_callback(window, self.glfw_mouse_scroll_callback)
        glfw.set_window_focus_callback(window, self.glfw_window_focus)
        glfw.set_window_iconify_callback(window, self.glfw_window_iconify)
        glfw.set_window_close_callback(window, self.glfw_window_close)
        glfw.set_framebuffer_size_callback(window, self._on_buffer_size)
        glfw.set_drop_callback(window, self._on_drop)

    def glfw_mouse_event_callback(
        self, _: Any, xpos: float, ypos: float
    ) -> None:
        """Pass a motion on, whose place moderngl-window would round."""
        before_x, before_y = self._pointer or (xpos, ypos)
        self._pointer = (xpos, ypos)
        self.pointer_func(xpos, ypos, xpos - before_x, ypos - before_y)

    def glfw_window_focus(self, window: Any, focused: int) -> None:
        """Pass on whether the window got the keyboard or lost it."""
        super().glfw_window_focus(window, focused)
        self.focus_func(bool(focused))

    def _on_buffer_size(self, window: Any, _: int, __: int) -> None:
        """Also where pixels change and screen coordinates do not.

        So it is on a window that is moved to a screen of another scale.
        """
        self.glfw_window_resize_callback(window, *glfw.get_window_size(window))

    def _on_drop(self, window: Any, paths: list[str]) -> None:
        x, y = glfw.get_cursor_pos(window)
        self.files_dropped_event_func(int(x), int(y), list(paths))

    def _handle_modifiers(self, mods: int) -> None:
        """Keep all bits: moderngl-window knows three of the modifiers."""
        super()._handle_modifiers(mods)
        self.held = mods

    def _handle_mouse_button_state_change(
        self, button: int, pressed: bool
    ) -> None:
        """Keep the state of the three buttons that it knows."""
        if button in (self.mouse.left, self.mouse.right, self.mouse.middle):
            super()._handle_mouse_button_state_change(button, pressed)


def _last_error() -> str:
    """GLFW's last error on this thread."""
    _, text = glfw.get_error()
    return (text or b"GLFW gives no reason").decode("utf-8", "replace")
