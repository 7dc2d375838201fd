"""The context of a visible GLFW window, handed over between threads.

GLFW wants windows and events on the main thread, while a context may be
current on any. So the main thread makes the window, and the render thread
takes its context.
"""

import ctypes
from typing import Any

from moka.backend.contexts.context import GraphicsContext
from moka.backend.contexts.native import NativeContext
from moka.core.errors import ContextError

__all__ = ["WindowContext"]


class WindowContext(GraphicsContext):
    """The context of a GLFW window, for the thread that draws into it.

    Made on that thread, with a window of the main thread that is current
    nowhere. GLFW destroys the OpenGL context together with the window, which
    must outlive this object. Raises ContextError.
    """

    def __init__(
        self, window: Any, *, vsync: bool = True, debug: bool = False
    ) -> None:
        import glfw

        self._window = window
        super().__init__(_GlfwContext(window), debug=debug)
        glfw.swap_interval(int(vsync))

    def swap(self) -> None:
        """Show what was drawn into framebuffer 0; waits when vsync is on."""
        import glfw

        glfw.swap_buffers(self._window)

    def close(self) -> None:
        """As for every context; what the driver holds dies with the window.

        So the driver must forget where to report messages.
        """
        if self._debug is not None and not self._closed:
            self.make_current()
            self._debug.stop()
        super().close()


class _GlfwContext(NativeContext):
    """The context that GLFW made together with its window."""

    kind = "window"
    label = "window"
    has_surface = True

    def __init__(self, window: Any) -> None:
        self._window = window
        self.make_current()

    def make_current(self) -> None:
        import glfw

        glfw.make_context_current(self._window)
        if not self._is_current():
            raise ContextError("the context of the window cannot be taken")

    def release_current(self) -> None:
        import glfw

        nothing: Any = None
        glfw.make_context_current(nothing)

    def destroy(self) -> None:
        if self._is_current():
            self.release_current()

    def load_opengl_function(self, name: str) -> int:
        import glfw

        return _address(glfw.get_proc_address(name))

    def _is_current(self) -> bool:
        import glfw

        return _address(glfw.get_current_context()) == _address(self._window)


def _address(pointer: Any) -> int:
    """What ``pointer`` of ``ctypes`` points to, 0 for a null pointer."""
    return ctypes.cast(pointer, ctypes.c_void_p).value or 0
