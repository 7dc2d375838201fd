"""Jobs in the background, and their results in the foreground."""

import threading

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
