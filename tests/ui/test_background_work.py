"""Jobs in the background, and their results in the foreground."""

import threading
import time

import pytest

from moka.ui.background_work import BackgroundWork


def finished(work: BackgroundWork, woken: threading.Event) -> None:
    while work.doing:
        assert woken.wait(10)
        woken.clear()
        work.poll()


def test_results_arrive_in_order_on_the_thread_that_polls() -> None:
    woken = threading.Event()
    work = BackgroundWork(woken.set)
    seen: list[tuple[int, bool, bool]] = []
    here = threading.get_ident()

    def then(result: tuple[int, int]) -> None:
        number, elsewhere = result
        same = threading.get_ident() == here
        seen.append((number, elsewhere != here, same))

    for number in range(3):
        work.start(
            f"job {number}",
            lambda number=number: (number, threading.get_ident()),
            then,
        )
    assert work.doing == "job 0"
    finished(work, woken)
    assert seen == [(0, True, True), (1, True, True), (2, True, True)]
    assert work.doing is None
    work.close()


def test_what_a_job_raises_is_raised_by_the_poll() -> None:
    woken = threading.Event()
    work = BackgroundWork(woken.set)

    def fail() -> None:
        raise ValueError("no file")

    work.start("reading", fail, lambda _: None)
    assert woken.wait(10)
    with pytest.raises(ValueError, match="no file"):
        work.poll()
    assert work.doing is None
    work.close()


def test_a_job_tells_what_it_is_about_until_it_is_over() -> None:
    woken, go_on = threading.Event(), threading.Event()
    work = BackgroundWork(woken.set)

    def job() -> None:
        work.tell("image 3 of 4")
        assert go_on.wait(10)

    work.start("reading", job, lambda _: None)
    assert woken.wait(10)
    assert work.doing == "image 3 of 4"
    go_on.set()
    finished(work, woken)
    assert work.doing is None
    work.start("writing", lambda: None, lambda _: None)
    assert work.doing == "writing"
    work.close()


def test_two_jobs_go_on_at_once_and_the_first_comes_first() -> None:
    woken, second_is_done = threading.Event(), threading.Event()
    work = BackgroundWork(woken.set)
    seen: list[str] = []

    def first() -> str:
        assert second_is_done.wait(10)
        return "first"

    def second() -> str:
        second_is_done.set()
        return "second"

    for job in (first, second):
        work.start("reading", job, seen.append)
    finished(work, woken)
    assert seen == ["first", "second"]
    work.close()


def test_a_job_that_nobody_waits_for_ends_when_it_tells() -> None:
    begun, told = threading.Event(), []
    work = BackgroundWork(lambda: None)

    def job() -> None:
        begun.set()
        for number in range(10_000):
            work.tell(f"image {number}")
            told.append(number)
            time.sleep(0.01)

    work.start("reading", job, lambda _: None)
    assert begun.wait(10)
    work.close()
    assert len(told) < 9_000
