"""Work that a window does not wait for: reading files, writing pictures."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

__all__ = ["BackgroundWork"]

Result = TypeVar("Result")


class BackgroundWork:
    """Jobs on a thread of their own, one after the other.

    What a job returns is handed over on the thread that calls :meth:`poll`.
    ``wake`` is called, from any thread, when there is something to poll for.
    """

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="moka-background")
        self._jobs: list[tuple[str, Future[Any], Callable[[Any], None]]] = []

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
        return self._jobs[0][0] if self._jobs else None

    def poll(self) -> None:
        """Hand over what is done; raises what a job raised."""
        while self._jobs and self._jobs[0][1].done():
            _, future, then = self._jobs.pop(0)
            then(future.result())

    def close(self) -> None:
        """Forget what has not begun, and wait for what has."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._jobs.clear()
