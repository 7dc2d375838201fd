"""The backend in a context of another program."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from moka.backend.contexts.embedded import EmbeddedContext
from moka.backend.gl_functions import Functions
from moka.backend.host_state import HostState
from moka.backend.moderngl_backend import ModernGLBackend
from moka.commands.descriptors import ProgramDescriptor, ShaderText
from moka.commands.handles import Handle

__all__ = ["EmbeddedBackend"]


class EmbeddedBackend(ModernGLBackend):
    """A guest: every job runs within :meth:`visit`.

    In between the host sets what it likes, and it finds it again. The
    framebuffer that it draws into stands for a window.
    """

    def __init__(
        self,
        context: EmbeddedContext,
        explain: Callable[[str, ShaderText], str],
    ) -> None:
        # As many texture units as the program that reads most of them.
        self._units = 0
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
            blocks=len(self._blocks), units=self._units
        ) as framebuffer:
            self._state.forget()
            self._runner.window = framebuffer
            self._set_defaults()
            yield

    def create_program(
        self, handle: Handle, descriptor: ProgramDescriptor
    ) -> None:
        """See :class:`moka.backend.protocol.Backend`."""
        super().create_program(handle, descriptor)
        self._units = max(self._units, len(self._get(handle).samplers))
