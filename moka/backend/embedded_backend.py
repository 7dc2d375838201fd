"""The backend in a context of another program."""

from collections.abc import Iterator
from contextlib import contextmanager

from moka.backend.contexts.embedded import EmbeddedContext
from moka.backend.gl_functions import Functions
from moka.backend.gl_programs import Explain
from moka.backend.host_state import HostState
from moka.backend.moderngl_backend import ModernGLBackend

__all__ = ["EmbeddedBackend"]


class EmbeddedBackend(ModernGLBackend):
    """A guest: every job runs within :meth:`visit`.

    In between the host sets what it likes, and it finds it again. The
    framebuffer that it draws into stands for a window.
    """

    def __init__(
        self,
        context: EmbeddedContext,
        explain: Explain,
    ) -> None:
        self._host = HostState(Functions(context.function), context.gl)
        collects = context.gl.gc_mode
        try:
            with self._host.kept():
                # Whoever waits for pixels is the one who would fetch them.
                super().__init__(context, explain, asynchronous=False)
        finally:
            context.gl.gc_mode = collects

    @contextmanager
    def visit(self) -> Iterator[None]:
        """See :class:`moka.graphics.calling_thread.GuestBackend`."""
        with self._host.kept(
            blocks=len(self._points), units=self._points.units
        ) as framebuffer:
            self._state.forget()
            self._runner.window = framebuffer
            self._set_defaults()
            yield
            # What a host has asked for is done when its call returns.
            self.finish_programs()
