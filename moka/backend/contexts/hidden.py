"""OpenGL through a window that is never shown, the last resort.

ModernGL's own ``glcontext`` makes it: a 1x1 window on X11 and on Windows,
and on macOS a CGL context that needs no window. Unlike GLFW, which is bound
to the main thread, this works on the thread that renders.
"""

import ctypes
import os
import sys
from functools import partial
from typing import Any

from moka.backend.contexts.native import NativeContext, load_library
from moka.core.errors import ContextError

__all__ = ["HiddenWindowContext"]

_MACOS_OPENGL = "/System/Library/Frameworks/OpenGL.framework/OpenGL"


class HiddenWindowContext(NativeContext):
    """A core context of OpenGL 3.3 or later on the system's display."""

    kind = "window"
    label = "hidden window"
    # On macOS there is no default framebuffer; told so, ModernGL makes one.
    standalone = True

    def __init__(self) -> None:
        import glcontext  # type: ignore[import-untyped]

        settings: dict[str, Any] = {"mode": "standalone", "glversion": 330}
        if sys.platform.startswith("linux"):
            if not os.environ.get("DISPLAY"):
                raise ContextError("DISPLAY is not set")
            settings |= {"libgl": "libGL.so.1", "libx11": "libX11.so.6"}
        try:
            self._loader = glcontext.default_backend()(**settings)
        except Exception as error:  # glcontext raises nothing narrower
            raise ContextError(str(error)) from error
        self._destroyed = False

    def make_current(self) -> None:
        self._loader.__enter__()

    def release_current(self) -> None:
        # The loader's __exit__ goes back to what was current before its
        # __enter__, which may well be this context.
        _unbind()

    def destroy(self) -> None:
        if not self._destroyed:
            self._destroyed = True
            self._loader.release()

    def load_opengl_function(self, name: str) -> int:
        return int(self._loader.load_opengl_function(name))


def _unbind() -> None:
    """Leave this thread without a context of the window system."""
    if sys.platform == "win32":
        library = load_library("opengl32.dll")
        unbind = partial(library["wglMakeCurrent"], None, None)
    elif sys.platform == "darwin":
        library = load_library(_MACOS_OPENGL)
        unbind = partial(library["CGLSetCurrentContext"], None)
    else:
        library = load_library("libGL.so.1")
        display = library["glXGetCurrentDisplay"]
        display.restype = ctypes.c_void_p
        current = display()
        if not current:
            return
        unbind = partial(
            library["glXMakeCurrent"], ctypes.c_void_p(current), 0, None
        )
    unbind()
