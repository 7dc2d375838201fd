"""Runs a device's jobs at once, on the thread of its caller.

What :class:`moka.graphics.render_thread.RenderThread` is to a context of
moka's own: here the context is another program's, current on the thread that
embeds moka. What other threads post (decoded images, mostly) waits for the
next call from that thread. Errors are raised there, and leave the device
usable.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import AbstractContextManager
from typing import Protocol, TypeVar

from moka.backend.protocol import Backend
from moka.core.errors import DeviceError

__all__ = ["CallingThread", "GuestBackend"]

T = TypeVar("T")


class GuestBackend(Backend, Protocol):
    """A backend in a context of another program."""

    def visit(self) -> AbstractContextManager[None]:
        """Around jobs: the host's state is put back at the end."""


class CallingThread:
    """Calls jobs with the backend that ``open_backend`` makes here."""

    def __init__(self, open_backend: Callable[[], GuestBackend]) -> None:
        self._thread = threading.current_thread()
        self._posted: queue.SimpleQueue[Callable[[Backend], None]] = (
            queue.SimpleQueue()
        )
        self._is_busy = False
        self._backend: GuestBackend | None = open_backend()

    def wait_until_open(self) -> None:
        """Return: it is open from the start."""

    def post(self, function: Callable[[Backend], T]) -> Future[T]:
        """Run ``function`` now, or soon if this is another thread.

        Soon also within a job, as when the collector drops a resource there.
        """
        if self._backend is None:
            raise DeviceError("the graphics device is closed")
        future: Future[T] = Future()
        self._posted.put(lambda backend: _answer(future, function, backend))
        if not self._is_busy and threading.current_thread() is self._thread:
            self.call(lambda _: None)
        return future

    def call(self, function: Callable[[Backend], T]) -> T:
        """Run ``function`` now and return what it returns."""
        if self._backend is None:
            raise DeviceError("the graphics device is closed")
        self._check_thread()
        with self._backend.visit():
            self._is_busy = True
            try:
                while not self._posted.empty():
                    self._posted.get()(self._backend)
                return function(self._backend)
            finally:
                self._is_busy = False

    def wait(self, future: Future[T]) -> T:
        """The result of a posted job."""
        if not future.done():
            self.call(lambda _: None)
        return future.result()

    def close(self) -> bool:
        """Free what the jobs have made; the context stays."""
        if self._backend is not None:
            self._check_thread()
            with self._backend.visit():
                self._backend.close()
            self.abandon()
        return True

    def abandon(self) -> None:
        """Forget the backend, whose context may be gone by now.

        What was made stays in the host's context until that is released.
        """
        self._backend = None

    def _check_thread(self) -> None:
        here = threading.current_thread()
        if here is not self._thread:
            raise DeviceError(
                f"embedded device: belongs to thread {self._thread.name}, and "
                f"was called from {here.name}; call it where it was embedded"
            )


def _answer(
    future: Future[T], function: Callable[[Backend], T], backend: Backend
) -> None:
    try:
        future.set_result(function(backend))
    except BaseException as error:
        future.set_exception(error)
        raise
