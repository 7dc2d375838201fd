"""Work that a window does not wait for: reading files, writing pictures."""

from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from time import monotonic
from typing import Any, TypeVar

__all__ = ["BackgroundWork"]

Result = TypeVar("Result")

# Seconds from one word of a job's progress to the next that is shown.
_TELLING_INTERVAL = 0.2


class BackgroundWork:
    """Jobs on two threads of their own, begun one after the other.

    What a job returns is handed over on the thread that calls :meth:`poll`,
    in the order in which the jobs were begun. ``wake`` is called, from any
    thread, when there is something to poll for or to show.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._pool = ThreadPoolExecutor(2, thread_name_prefix="moka-background")
        self._jobs: list[tuple[str, Future[Any], Callable[[Any], None]]] = []
        self._detail = ""
        self._told = 0.0
        self._closed = False

    def start(
        self,
        what: str,
        job: Callable[[], Result],
        then: Callable[[Result], None],
    ) -> None:
        """Do ``job`` elsewhere, ``then`` something with its result here."""
        future = self._pool.submit(job)
        self._jobs.append((what, future, then))
        future.add_done_callback(lambda _: self._wake())

    @property
    def doing(self) -> str | None:
        """What is being done, for a person; None if nothing is."""
        if not self._jobs:
            return None
        return self._detail or self._jobs[0][0]

    def tell(self, detail: str) -> None:
        """Say what a job is about; for the job itself, on its thread.

        Raises CancelledError when nobody waits for the job any more.
        """
        if self._closed:
            raise CancelledError
        self._detail = detail
        # A picture for each would take the work's time away.
        if monotonic() - self._told > _TELLING_INTERVAL:
            self._told = monotonic()
            self._wake()

    def poll(self) -> None:
        """Hand over what is done; raises what a job raised."""
        while self._jobs and self._jobs[0][1].done():
            _, future, then = self._jobs.pop(0)
            self._detail = ""
            then(future.result())

    def close(self) -> None:
        """Forget what has not begun, and wait for what has."""
        self._closed = True
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._jobs.clear()
