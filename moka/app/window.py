"""A window on the screen: its events here, its pictures from elsewhere.

It uses GLFW directly. moderngl-window makes its ModernGL context on the
thread that opens the window, whereas here the render thread makes it.
"""

import sys
import threading
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

from moka.app.events import (
    CloseEvent,
    DropEvent,
    Event,
    FocusEvent,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ResizeEvent,
    ScrollEvent,
    TextEvent,
)
from moka.app.gamepads import read_gamepads
from moka.app.input import Gamepad
from moka.app.keys import Key, Modifiers, MouseButton
from moka.core.errors import ContextError

if TYPE_CHECKING:
    from moka.backend.contexts import WindowContext

__all__ = ["Window"]

_ALL_MODIFIERS = ~Modifiers.NONE


class Window:
    """A window of the main thread whose content another thread draws.

    ``size`` is in screen coordinates, which differ from pixels on a scaled
    display. ``debug`` asks for a debug context. An EGL context that is
    current on this thread is let go: GLX cannot share one with it. Raises
    ContextError if there is no display, no GLFW, or no OpenGL 3.3.
    """

    def __init__(
        self,
        title: str = "moka",
        size: tuple[int, int] = (1280, 720),
        *,
        vsync: bool = True,
        resizable: bool = True,
        visible: bool = True,
        fullscreen: bool = False,
        debug: bool = False,
    ) -> None:
        if threading.current_thread() is not threading.main_thread():
            raise ContextError("a window must be made on the main thread")
        from moka.backend.contexts.egl import release_thread

        release_thread()
        self._glfw = glfw = _start_glfw()
        self._vsync = vsync
        self._debug = debug
        self._events: list[Event] = []
        self._pointer: tuple[float, float] | None = None
        self._context: WindowContext | None = None
        glfw.default_window_hints()
        for hint, value in (
            (glfw.CONTEXT_VERSION_MAJOR, 3),
            (glfw.CONTEXT_VERSION_MINOR, 3),
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
        self._window = glfw.create_window(*size, title, None, None)
        if not self._window:
            raise ContextError(f"no window can be opened: {_last_error(glfw)}")
        self._placed: tuple[int, int, int, int] | None = None
        self._listen()
        if fullscreen:
            self.fullscreen = True

    def __enter__(self) -> "Window":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the content in screen coordinates."""
        width, height = self._glfw.get_window_size(self._window)
        return width, height

    @property
    def framebuffer_size(self) -> tuple[int, int]:
        """Width and height in pixels, for the viewport; may be zero."""
        width, height = self._glfw.get_framebuffer_size(self._window)
        return width, height

    @property
    def content_scale(self) -> float:
        """By how much a person has text and buttons enlarged, 1 or more."""
        across, down = self._glfw.get_window_content_scale(self._window)
        return float(max(across, down, 1.0))

    @property
    def is_hidden(self) -> bool:
        """Whether nothing of it can be seen, as when it is minimised."""
        glfw = self._glfw
        return 0 in self.framebuffer_size or bool(
            glfw.get_window_attrib(self._window, glfw.ICONIFIED)
        )

    @property
    def fullscreen(self) -> bool:
        """Whether it fills a screen; set it to change that."""
        return bool(self._glfw.get_window_monitor(self._window))

    @fullscreen.setter
    def fullscreen(self, value: bool) -> None:
        glfw, window = self._glfw, self._window
        if value == self.fullscreen:
            return
        if not value:
            place = self._placed or (0, 0, *self.size)
            glfw.set_window_monitor(window, None, *place, glfw.DONT_CARE)
            return
        self._placed = (*glfw.get_window_pos(window), *self.size)
        monitor = glfw.get_primary_monitor()
        if not monitor:
            return
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(
            window, monitor, 0, 0, *mode.size, mode.refresh_rate
        )

    @property
    def clipboard(self) -> str:
        """The text on the clipboard; set it to copy one there."""
        text = self._glfw.get_clipboard_string(None)
        return (text or b"").decode("utf-8", "replace")

    @clipboard.setter
    def clipboard(self, text: str) -> None:
        self._glfw.set_clipboard_string(None, text)

    @property
    def captures_pointer(self) -> bool:
        """Whether the pointer is hidden and moves without bounds."""
        glfw = self._glfw
        mode = glfw.get_input_mode(self._window, glfw.CURSOR)
        return bool(mode == glfw.CURSOR_DISABLED)

    @captures_pointer.setter
    def captures_pointer(self, value: bool) -> None:
        glfw = self._glfw
        mode = glfw.CURSOR_DISABLED if value else glfw.CURSOR_NORMAL
        glfw.set_input_mode(self._window, glfw.CURSOR, mode)

    @property
    def gamepads(self) -> list[Gamepad]:
        """The gamepads that are plugged in, as they are now."""
        return read_gamepads(self._glfw)

    @property
    def should_close(self) -> bool:
        """Whether somebody has asked for the window to be closed."""
        return self._window is None or bool(
            self._glfw.window_should_close(self._window)
        )

    def request_close(self) -> None:
        """Make :attr:`should_close` true, as a click on the cross does."""
        self._glfw.set_window_should_close(self._window, True)

    def set_title(self, title: str) -> None:
        """Change what the title bar says."""
        self._glfw.set_window_title(self._window, title)

    def poll(self, timeout: float = 0.0) -> list[Event]:
        """What has happened since the last call, oldest first.

        If that is nothing, waits for something, or for :meth:`wake`, up to
        ``timeout`` seconds.
        """
        if timeout > 0:
            self._glfw.wait_events_timeout(timeout)
        else:
            self._glfw.poll_events()
        events = self._events.copy()
        self._events.clear()
        return events

    def wake(self) -> None:
        """End a :meth:`poll` that waits; from any thread."""
        self._glfw.post_empty_event()

    def context_factory(self) -> Callable[[], "WindowContext"]:
        """What makes the OpenGL context, called on the render thread.

        Only one context can be made; close it before the window.
        """

        def make() -> "WindowContext":
            from moka.backend.contexts import WindowContext

            self._context = WindowContext(
                self._window, vsync=self._vsync, debug=self._debug
            )
            return self._context

        return make

    def close(self) -> None:
        """Take the window off the screen; twice does no harm.

        Raises ContextError while a living render thread has its context,
        because drivers crash then.
        """
        if self._window is None:
            return
        if self._context is not None:
            self._context.close()
        self._glfw.destroy_window(self._window)
        self._window = None

    def _listen(self) -> None:
        """Append an event for whatever GLFW reports.

        Nothing here may raise: GLFW's binding keeps an exception in one
        place for all threads, and the render thread could be hit by it.
        """
        glfw, window = self._glfw, self._window
        add = self._events.append
        glfw.set_window_close_callback(window, lambda _: add(CloseEvent()))
        glfw.set_framebuffer_size_callback(
            window, lambda _, width, height: add(ResizeEvent(width, height))
        )
        glfw.set_scroll_callback(
            window, lambda _, dx, dy: add(ScrollEvent(dx, dy))
        )
        glfw.set_char_callback(
            window, lambda _, code: add(TextEvent(chr(code)))
        )
        glfw.set_window_focus_callback(
            window, lambda _, focused: add(FocusEvent(bool(focused)))
        )
        glfw.set_drop_callback(
            window, lambda _, paths: add(DropEvent(tuple(paths)))
        )
        glfw.set_key_callback(window, self._on_key)
        glfw.set_cursor_pos_callback(window, self._on_move)
        glfw.set_mouse_button_callback(window, self._on_button)

    def _on_key(
        self, _: object, code: int, __: int, action: int, held: int
    ) -> None:
        key = _keys().get(code, Key.UNKNOWN)
        pressed = action != self._glfw.RELEASE
        repeated = action == self._glfw.REPEAT
        modifiers = Modifiers(held & _ALL_MODIFIERS)
        self._events.append(KeyEvent(key, pressed, repeated, modifiers))

    def _on_move(self, _: object, x: float, y: float) -> None:
        before_x, before_y = self._pointer or (x, y)
        self._pointer = (x, y)
        self._events.append(MouseMoveEvent(x, y, x - before_x, y - before_y))

    def _on_button(
        self, _: object, button: int, action: int, held: int
    ) -> None:
        if button >= len(MouseButton):
            return
        x, y = self._glfw.get_cursor_pos(self._window)
        self._events.append(
            MouseButtonEvent(
                MouseButton(button + 1),
                action == self._glfw.PRESS,
                *(x, y),
                Modifiers(held & _ALL_MODIFIERS),
            )
        )


def _start_glfw() -> Any:
    """The module ``glfw``, initialised."""
    try:
        import glfw
    except ImportError as error:
        raise ContextError(
            "a window needs GLFW: pip install 'moka-pbr[window]'"
        ) from error
    # Errors are asked for where they matter and not printed as warnings.
    glfw.ERROR_REPORTING = "log"
    if not glfw.init():
        raise ContextError(
            f"no window can be opened: {_last_error(glfw)}; run with a "
            "display, for instance under xvfb-run, or headless"
        )
    return glfw


def _last_error(glfw: Any) -> str:
    """GLFW's last error on this thread."""
    _, text = glfw.get_error()
    return (text or b"GLFW gives no reason").decode("utf-8", "replace")


@cache
def _keys() -> dict[int, Key]:
    """Our keys by GLFW's codes."""
    import glfw

    names = {
        key: key.name.replace("KEYPAD_", "KP_").removeprefix("DIGIT_")
        for key in Key
    }
    return {getattr(glfw, f"KEY_{name}"): key for key, name in names.items()}
