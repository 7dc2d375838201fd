"""The thread that owns the GL context and is the only one that speaks GL.

Jobs run in the order they are posted. A job whose caller waits for it
(:meth:`RenderThread.call`) reports its exception to that caller and nothing
else happens; a job that nobody waits for (:meth:`RenderThread.post`) makes
the thread *failed*: its exception is raised, with its own traceback, at the
next call from outside, and from then on only :meth:`RenderThread.close`
does anything. No wait is without a bound: whoever waits looks twice a second
whether the thread is alive and gives up after ``timeout`` seconds.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import TYPE_CHECKING, Generic, TypeVar

from moka.core.errors import DeviceError

if TYPE_CHECKING:
    from moka.backend.protocol import Backend

__all__ = ["RenderThread"]

T = TypeVar("T")

_POLL_SECONDS = 0.5
# How often a thread without a job looks for pixels that are on their way.
_TAKE_UP_SECONDS = 0.001


class _Job(Generic[T]):
    """A function to run on the thread and where its result goes."""

    __slots__ = ("function", "future", "is_awaited")

    def __init__(
        self, function: Callable[[Backend], T], *, is_awaited: bool
    ) -> None:
        self.function = function
        self.future: Future[T] = Future()
        self.is_awaited = is_awaited

    def run(self, backend: Backend) -> BaseException | None:
        try:
            self.future.set_result(self.function(backend))
        except BaseException as error:
            self.future.set_exception(error)
            return None if self.is_awaited else error
        return None


class _Worker:
    """The thread's side; holds no reference to RenderThread.

    So that a RenderThread that nobody holds any more can be collected, which
    ends the worker.
    """

    def __init__(self, open_backend: Callable[[], Backend]) -> None:
        self.jobs: queue.SimpleQueue[_Job[object] | None] = queue.SimpleQueue()
        self.opened: Future[None] = Future()
        self.failure: BaseException | None = None
        self._open_backend = open_backend

    def run(self) -> None:
        try:
            backend = self._open_backend()
        except BaseException as error:
            self.opened.set_exception(error)
            self._refuse_rest()
            return
        self.opened.set_result(None)
        try:
            while (job := self._next(backend)) is not None:
                if self.failure is None:
                    self.failure = job.run(backend)
                else:
                    job.future.set_exception(_refusal())
                # A job keeps arrays alive; drop it before waiting again.
                del job
        finally:
            # Whatever closing runs into, nobody may be left waiting.
            with contextlib.suppress(Exception):
                backend.close()
            self._refuse_rest()

    def _next(self, backend: Backend) -> _Job[object] | None:
        """The next job; pixels are taken up while there is none."""
        while backend.poll():
            with contextlib.suppress(queue.Empty):
                return self.jobs.get(timeout=_TAKE_UP_SECONDS)
        return self.jobs.get()

    def _refuse_rest(self) -> None:
        while True:
            try:
                job = self.jobs.get_nowait()
            except queue.Empty:
                return
            if job is not None:
                job.future.set_exception(_refusal())


class RenderThread:
    """Starts the thread; posts jobs to it; ends it in every case.

    ``open_backend`` runs on the thread and makes the context current there;
    the constructor doesn't wait for it: the first call does, and raises what
    it raised.
    """

    def __init__(
        self, open_backend: Callable[[], Backend], *, timeout: float = 600.0
    ) -> None:
        self._timeout = timeout
        self._worker = _Worker(open_backend)
        self._closed = False
        self._thread = threading.Thread(
            target=self._worker.run, name="moka-render", daemon=True
        )
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether the thread still runs."""
        return self._thread.is_alive()

    def wait_until_open(self) -> None:
        """Return when the context is made; raise what making it raised."""
        self._wait(self._worker.opened)

    def post(self, function: Callable[[Backend], T]) -> Future[T]:
        """Run ``function`` on the thread later; see the module's text."""
        return self._enqueue(_Job(function, is_awaited=False))

    def call(self, function: Callable[[Backend], T]) -> T:
        """Run ``function`` on the thread and return what it returns."""
        return self.wait(self._enqueue(_Job(function, is_awaited=True)))

    def wait(self, future: Future[T]) -> T:
        """The result of a posted job; raises DeviceError after the bound."""
        try:
            return self._wait(future)
        except BaseException:
            self._raise_failure()
            raise

    def close(self, timeout: float = 10.0) -> bool:
        """End the thread after what was posted; whether it has ended."""
        if not self._closed:
            self._closed = True
            self._worker.jobs.put(None)
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def abandon(self) -> None:
        """End the thread without waiting until it has ended."""
        self.close(timeout=0.0)

    def _enqueue(self, job: _Job[T]) -> Future[T]:
        if self._closed:
            raise DeviceError("the graphics device is closed")
        if self._worker.opened.done():
            self._worker.opened.result()
        self._raise_failure()
        self._worker.jobs.put(job)  # type: ignore[arg-type]
        return job.future

    def _raise_failure(self) -> None:
        failure = self._worker.failure
        if failure is not None:
            raise failure

    def _wait(self, future: Future[T]) -> T:
        deadline = time.monotonic() + self._timeout
        while True:
            try:
                return future.result(_POLL_SECONDS)
            except FutureTimeoutError:
                if future.done():
                    raise
                if not self._thread.is_alive():
                    raise DeviceError(
                        "the render thread has ended without an answer"
                    ) from None
                if time.monotonic() > deadline:
                    raise DeviceError(
                        "the render thread has not answered for "
                        f"{self._timeout:.0f} s"
                    ) from None


def _refusal() -> DeviceError:
    return DeviceError(
        "the graphics device refuses work after an error; close it"
    )
