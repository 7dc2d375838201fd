"""The context that a backend draws with, whoever made it."""

import ctypes
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from moka.backend.contexts.debug import DebugLog, DebugMessage
from moka.backend.contexts.native import NativeContext
from moka.core.errors import ContextError

if TYPE_CHECKING:
    import moderngl

__all__ = ["GraphicsContext"]

_REQUIRED_VERSION = 330
_TEXTURE_CUBE_MAP_SEAMLESS = 0x884F
_STRINGS = {
    "vendor": 0x1F00,
    "renderer": 0x1F01,
    "version": 0x1F02,
    "glsl": 0x8B8C,
}


class GraphicsContext:
    """A ModernGL context and the functions of OpenGL that ModernGL lacks.

    It belongs to the thread that made it until :meth:`release_current`
    there lets another thread take it with :meth:`make_current`. ``kind`` is
    ``egl``, ``osmesa``, ``window`` or ``embedded``, ``label`` says which of
    them to a person. ``gl`` collects dropped objects for ``gl.gc()``, because
    Python may drop them on a thread without a context.
    """

    def __init__(
        self,
        native: NativeContext,
        *,
        debug: bool = False,
        gl: "moderngl.Context | None" = None,
    ) -> None:
        """Wrap ``native``, which is current here and now owned by this.

        ``gl`` is its ModernGL context if there is one. Raises ContextError
        below OpenGL 3.3; ``native`` is destroyed then.
        """
        self.kind = native.kind
        self.label = native.label
        self._native = native
        self._owner: threading.Thread | None = threading.current_thread()
        self._functions: dict[object, Callable[..., Any]] = {}
        self._closed = False
        self._debug: DebugLog | None = None
        try:
            self.gl = _wrap(native) if gl is None else gl
            if debug:
                self._debug = DebugLog(
                    self.function,
                    has_debug_output=self.gl.version_code >= 430
                    or "GL_KHR_debug" in self.gl.extensions,
                )
        except BaseException:
            native.destroy()
            raise

    def __enter__(self) -> "GraphicsContext":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def function(self, name: str, result: Any, *arguments: Any) -> Any:
        """OpenGL function ``name`` with its ``ctypes`` result and arguments.

        Calls release the interpreter lock, those of ModernGL hold it. Some
        loaders give a function for every name: ask ``gl.version_code`` and
        ``gl.extensions`` whether it works. Raises ContextError if the loader
        has none or the context is closed.
        """
        key = (name, result, arguments)
        found = self._functions.get(key)
        if found is None:
            if self._closed:
                raise ContextError(f"{self.label}: the context is closed")
            address = self._native.load_opengl_function(name)
            if not address:
                raise ContextError(f"{self.label}: the driver has no {name}")
            found = ctypes.CFUNCTYPE(result, *arguments)(address)
            self._functions[key] = found
        return found

    def describe(self) -> dict[str, str]:
        """Vendor, renderer, version, GLSL version, and who made it."""
        get = self.function("glGetString", ctypes.c_char_p, ctypes.c_uint)
        texts = {
            name: (get(code) or b"").decode("utf-8", "replace")
            for name, code in _STRINGS.items()
        }
        return {"backend": self.kind, "context": self.label, **texts}

    def drain_debug_messages(self) -> list[DebugMessage]:
        """Messages of the driver since the last call; none without debug."""
        return [] if self._debug is None else self._debug.drain()

    def make_current(self) -> None:
        """Take the context to this thread.

        Raises ContextError if a living thread has not released it, or if
        the driver keeps it for a thread that ended without releasing it.
        """
        self._check_thread()
        self._native.make_current()
        self._owner = threading.current_thread()

    def release_current(self) -> None:
        """Let go of the context, for another thread to take."""
        self._check_thread()
        self._native.release_current()
        self._owner = None

    def close(self) -> None:
        """Destroy the context and everything in it; twice does no harm.

        Raises ContextError if another living thread still has it.
        """
        if self._closed:
            return
        self._check_thread()
        self._closed = True
        self._owner = None
        self._functions.clear()
        self.gl.release()

    def _check_thread(self) -> None:
        if self._closed:
            raise ContextError(f"{self.label}: the context is closed")
        owner = self._owner
        if owner is None or owner is threading.current_thread():
            return
        if owner.is_alive():
            raise ContextError(
                f"{self.label}: the context belongs to thread {owner.name}; "
                "release it there first"
            )
        self._owner = None


def _wrap(native: NativeContext) -> "moderngl.Context":
    """A ModernGL context for ``native``."""
    import moderngl

    settings: dict[str, Any] = {"context": native}
    try:
        gl = moderngl.create_context(
            require=_REQUIRED_VERSION,
            standalone=not native.has_surface,
            **settings,
        )
    except (ValueError, moderngl.Error) as error:
        raise ContextError(f"{native.label}: {error}") from error
    gl.gc_mode = "context_gc"
    gl.enable_direct(_TEXTURE_CUBE_MAP_SEAMLESS)
    return gl
