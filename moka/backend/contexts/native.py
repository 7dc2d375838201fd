"""What a window system gives: an OpenGL context and its functions."""

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

from moka.core.errors import ContextError

__all__ = ["NativeContext", "bind", "load_library"]


class NativeContext(ABC):
    """An OpenGL context of one window system, without ModernGL around it.

    At any time at most one thread has it current, and a constructor leaves
    it current on the thread that called it. ``load_opengl_function`` and
    the methods at the end are what ModernGL asks of a context.
    """

    kind: str
    label: str
    # Whether framebuffer 0 can be drawn into.
    has_surface = False

    @abstractmethod
    def make_current(self) -> None:
        """Bind to this thread; ContextError if another thread has it."""

    @abstractmethod
    def release_current(self) -> None:
        """Leave this thread without a context."""

    @abstractmethod
    def destroy(self) -> None:
        """Destroy the context, from any thread; twice does no harm."""

    @abstractmethod
    def load_opengl_function(self, name: str) -> int:
        """The address of an OpenGL function, 0 where there is none."""

    def __enter__(self) -> None:
        self.make_current()

    def __exit__(self, *exception: object) -> None:
        self.release_current()

    def release(self) -> None:
        self.destroy()


def load_library(*names: str) -> ctypes.CDLL:
    """The first of the shared libraries ``names`` that can be loaded.

    Exact names are given because ``ctypes.util.find_library`` may start a
    compiler to guess them, which takes longer than making a context. Calls
    into the library release the interpreter lock.
    """
    causes = []
    for name in names:
        try:
            return ctypes.CDLL(name)
        except OSError as error:
            causes.append(str(error))
    raise ContextError(causes[0])


def bind(
    library: ctypes.CDLL, name: str, result: Any, *arguments: Any
) -> Callable[..., Any]:
    """Function ``name`` of ``library`` with its C types declared."""
    try:
        function = library[name]
    except AttributeError as error:
        raise ContextError(f"{library._name} has no {name}") from error
    function.restype = result
    function.argtypes = arguments
    return function
