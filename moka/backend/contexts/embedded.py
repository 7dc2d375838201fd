"""The context of another ModernGL program, in which moka is a guest."""

from typing import Any

from moka.backend.contexts.context import GraphicsContext
from moka.backend.contexts.native import NativeContext
from moka.core.errors import ContextError

__all__ = ["EmbeddedContext"]


class EmbeddedContext(GraphicsContext):
    """``gl``, a :class:`moderngl.Context` that is current on this thread.

    It stays its owner's: how it collects objects is not changed, and
    :meth:`close` lets it be. Raises ContextError for anything else, and
    below OpenGL 3.3.
    """

    def __init__(self, gl: Any) -> None:
        import moderngl

        if not isinstance(gl, moderngl.Context):
            raise ContextError(
                f"embedded: {type(gl).__name__} is no moderngl.Context"
            )
        if isinstance(gl.mglo, moderngl.InvalidObject):
            raise ContextError("embedded: the context has been released")
        if gl.version_code < 330:
            raise ContextError(
                f"embedded: OpenGL {gl.version_code / 100:.1f}, needs 3.3"
            )
        super().__init__(_HostContext(gl.mglo._context), gl=gl)

    def close(self) -> None:
        """Let go of the context; twice does no harm."""
        self._closed = True
        self._functions.clear()


class _HostContext(NativeContext):
    """The functions of the host's context, which the host makes current."""

    kind = "embedded"
    label = "embedded"

    def __init__(self, loader: Any) -> None:
        self._loader = loader

    def make_current(self) -> None:
        """Nothing: it is current whenever the host calls."""

    def release_current(self) -> None:
        """Nothing: the host goes on with it."""

    def destroy(self) -> None:
        """Nothing: it is the host's."""

    def load_opengl_function(self, name: str) -> int:
        return int(self._loader.load_opengl_function(name))
