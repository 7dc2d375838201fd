"""A window on the screen: its events here, its pictures from elsewhere.

moderngl-window keeps the window; what it has nothing for on GLFW is asked of
GLFW: waiting for events, the clipboard, the content scale and gamepads.
"""

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
        try:
            import glfw

            from moka.app.window_glfw import GlfwWindow, start_glfw
        except ImportError as error:
            raise ContextError(
                "a window needs moderngl-window and GLFW: "
                "pip install 'moka-pbr[window]'"
            ) from error
        start_glfw()
        self._glfw: Any = glfw
        self._debug = debug
        self._events: list[Event] = []
        self._context: WindowContext | None = None
        self._is_iconified = False
        self._is_closed = False
        self._window = GlfwWindow(
            title,
            size,
            resizable=resizable,
            visible=visible,
            vsync=vsync,
            debug=debug,
        )
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
        return self._window.size

    @property
    def framebuffer_size(self) -> tuple[int, int]:
        """Width and height in pixels, for the viewport; may be zero."""
        return self._window.buffer_size

    @property
    def content_scale(self) -> float:
        """By how much a person has text and buttons enlarged, 1 or more."""
        scales = self._glfw.get_window_content_scale(self._window.handle)
        return float(max(*scales, 1.0))

    @property
    def is_hidden(self) -> bool:
        """Whether nothing of it can be seen, as when it is minimised."""
        return self._is_iconified or 0 in self.framebuffer_size

    @property
    def fullscreen(self) -> bool:
        """Whether it fills a screen; set it to change that."""
        return self._window.fullscreen

    @fullscreen.setter
    def fullscreen(self, value: bool) -> None:
        if value != self.fullscreen and self._glfw.get_primary_monitor():
            self._window.fullscreen = value

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
        return self._window.mouse_exclusivity

    @captures_pointer.setter
    def captures_pointer(self, value: bool) -> None:
        self._window.mouse_exclusivity = value

    @property
    def gamepads(self) -> list[Gamepad]:
        """The gamepads that are plugged in, as they are now."""
        return read_gamepads(self._glfw)

    @property
    def should_close(self) -> bool:
        """Whether somebody has asked for the window to be closed."""
        return self._is_closed or bool(self._window.is_closing)

    def request_close(self) -> None:
        """Make :attr:`should_close` true, as a click on the cross does."""
        self._window.is_closing = True

    def set_title(self, title: str) -> None:
        """Change what the title bar says."""
        self._window.title = title

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
                self._window.handle,
                vsync=self._window.vsync,
                debug=self._debug,
            )
            return self._context

        return make

    def close(self) -> None:
        """Take the window off the screen; twice does no harm.

        Raises ContextError while a living render thread has its context,
        because drivers crash then.
        """
        if self._is_closed:
            return
        if self._context is not None:
            self._context.close()
        self._window.destroy()
        self._is_closed = True

    def _listen(self) -> None:
        """Append an event for whatever the window reports."""
        window, add = self._window, self._events.append
        window.key_event_func = self._on_key
        window.unicode_char_entered_func = lambda text: add(TextEvent(text))
        window.pointer_func = lambda *motion: add(MouseMoveEvent(*motion))
        window.mouse_press_event_func = self._on_button(True)
        window.mouse_release_event_func = self._on_button(False)
        window.mouse_scroll_event_func = lambda dx, dy: add(ScrollEvent(dx, dy))
        window.files_dropped_event_func = lambda _, __, paths: add(
            DropEvent(tuple(paths))
        )
        window.resize_func = lambda width, height: add(
            ResizeEvent(width, height)
        )
        window.iconify_func = self._on_iconify
        window.focus_func = lambda focused: add(FocusEvent(focused))
        window.close_func = lambda: add(CloseEvent())

    def _on_key(self, code: int, action: int, _: object) -> None:
        key = _keys().get(code, Key.UNKNOWN)
        pressed = action != self._glfw.RELEASE
        repeated = action == self._glfw.REPEAT
        self._events.append(KeyEvent(key, pressed, repeated, self._held))

    def _on_button(self, pressed: bool) -> Callable[[float, float, int], None]:
        def take(x: float, y: float, button: int) -> None:
            self._events.append(
                MouseButtonEvent(MouseButton(button), pressed, x, y, self._held)
            )

        return take

    def _on_iconify(self, is_iconified: bool) -> None:
        self._is_iconified = is_iconified

    @property
    def _held(self) -> Modifiers:
        return Modifiers(self._window.held & _ALL_MODIFIERS)


@cache
def _keys() -> dict[int, Key]:
    """Our keys by GLFW's codes; moderngl-window names only some of them."""
    import glfw

    names = {
        key: key.name.replace("KEYPAD_", "KP_").removeprefix("DIGIT_")
        for key in Key
    }
    return {getattr(glfw, f"KEY_{name}"): key for key, name in names.items()}
