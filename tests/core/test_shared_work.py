"""Pieces of work are each done once, by whoever is free."""

import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import pytest

from moka.core.shared_work import run_here, shared_with


def test_here_is_in_order() -> None:
    done: list[int] = []
    run_here(done.append, range(5))
    assert done == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("count", [0, 1, 15, 16, 100])
@pytest.mark.parametrize("workers", [1, 2, 5])
def test_every_piece_is_done_once(count: int, workers: int) -> None:
    with ThreadPoolExecutor(workers) as pool:
        done: list[int] = []
        shared_with(pool)(done.append, range(count))
        # By then, and not a moment later.
        assert Counter(done) == Counter(range(count))


def test_a_free_worker_helps() -> None:
    """Two pieces at a time wait for each other."""
    together = threading.Barrier(2, timeout=10.0)
    with ThreadPoolExecutor(1) as pool:
        shared_with(pool)(lambda _: together.wait(), range(16))


def test_a_worker_that_is_alone_does_them_itself() -> None:
    with ThreadPoolExecutor(1) as pool:
        names: set[str] = set()

        def work() -> None:
            shared_with(pool)(
                lambda _: names.add(threading.current_thread().name), range(64)
            )

        pool.submit(work).result(10.0)
        assert len(names) == 1
        assert names != {threading.current_thread().name}


def test_pieces_are_done_while_workers_are_shut_down() -> None:
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    done: list[int] = []
    shared_with(pool)(done.append, range(40))
    assert done == list(range(40))


@pytest.mark.parametrize("where", ["here", "in a worker"])
def test_an_error_anywhere_ends_it(where: str) -> None:
    here = threading.current_thread()
    both = threading.Barrier(2, timeout=10.0)
    done: list[int] = []

    def piece(number: int) -> None:
        if number < 2:
            both.wait()
        if (threading.current_thread() is here) == (where == "here"):
            raise ValueError("broken")
        done.append(number)

    with (
        ThreadPoolExecutor(1) as pool,
        pytest.raises(ValueError, match="broken"),
    ):
        shared_with(pool)(piece, range(1000))
    assert len(done) < 1000
