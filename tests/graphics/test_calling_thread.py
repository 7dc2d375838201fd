"""Jobs run at once where they are asked for; other threads' ones wait."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from moka.backend.protocol import Backend
from moka.backend.recording_backend import RecordingBackend
from moka.core.errors import DeviceError
from moka.graphics.calling_thread import CallingThread


class Guest(RecordingBackend):
    """Counts visits; jobs run within one."""

    visits = 0
    is_inside = False

    @contextmanager
    def visit(self) -> Iterator[None]:
        self.visits += 1
        self.is_inside = True
        try:
            yield
        finally:
            self.is_inside = False


def opened() -> tuple[CallingThread, Guest]:
    guest = Guest()
    return CallingThread(lambda: guest), guest


def elsewhere(thread: CallingThread, function: object) -> None:
    """Post from a thread that does not own the context."""
    worker = threading.Thread(target=thread.post, args=(function,))
    worker.start()
    worker.join()


def test_jobs_run_at_once_and_inside_a_visit() -> None:
    thread, guest = opened()
    future = thread.post(lambda _: guest.is_inside)
    assert future.done()
    assert thread.wait(future) is True
    assert thread.call(lambda _: guest.is_inside) is True
    assert not guest.is_inside


def test_what_others_post_runs_before_the_next_job() -> None:
    thread, guest = opened()
    seen: list[object] = []
    for number in range(2):
        elsewhere(thread, lambda _, n=number: seen.append(n))
    assert not seen
    visits = guest.visits
    thread.post(lambda _: seen.append("last"))
    assert seen == [0, 1, "last"]
    assert guest.visits == visits + 1


def test_waiting_runs_what_others_have_posted() -> None:
    thread, _ = opened()
    futures = []
    worker = threading.Thread(
        target=lambda: futures.append(thread.post(lambda _: 7))
    )
    worker.start()
    worker.join()
    assert thread.wait(futures[0]) == 7


def test_what_a_job_posts_waits_until_it_is_done() -> None:
    thread, guest = opened()
    seen: list[str] = []

    def job(_: Backend) -> None:
        thread.post(lambda _: seen.append("posted"))
        seen.append("job")

    visits = guest.visits
    thread.post(job)
    # By the same visit: nested ones would change what is bound.
    assert seen == ["job", "posted"]
    assert guest.visits == visits + 1


def test_an_error_is_raised_at_once_and_is_not_the_end() -> None:
    def fail(_: Backend) -> None:
        raise ZeroDivisionError("a fault in the driver")

    thread, guest = opened()
    for ask in (thread.post, thread.call):
        with pytest.raises(ZeroDivisionError):
            ask(fail)
        assert not guest.is_inside
    elsewhere(thread, fail)
    with pytest.raises(ZeroDivisionError):
        thread.call(lambda _: 1)
    assert thread.call(lambda _: 1) == 1


def test_a_closed_one_refuses_work() -> None:
    thread, guest = opened()
    assert thread.close()
    assert thread.close()
    for ask in (thread.post, thread.call):
        with pytest.raises(DeviceError, match="closed"):
            ask(lambda _: guest.is_inside)


def test_an_abandoned_one_makes_no_more_calls() -> None:
    thread, guest = opened()
    thread.abandon()
    assert thread.close()
    assert not guest.visits
