"""Parts of a model are worked on in threads that end."""

import threading
import time

import pytest

from moka.model.workers import map_in_workers


def names() -> set[str]:
    return {thread.name for thread in threading.enumerate()}


def test_results_keep_their_order_whoever_is_first() -> None:
    def slow_at_first(item: int) -> tuple[int, str]:
        time.sleep(0.02 / (1 + item))
        return item, threading.current_thread().name

    results = map_in_workers(slow_at_first, list(range(8)))
    assert [item for item, _ in results] == list(range(8))
    used = {name for _, name in results}
    assert all(name.startswith("moka-decompress") for name in used)
    assert not used & names()


def test_one_item_needs_no_thread() -> None:
    (name,) = map_in_workers(
        lambda _: threading.current_thread().name, ["only"]
    )
    assert name == threading.current_thread().name
    assert map_in_workers(str, []) == []


def test_the_first_item_that_fails_is_the_one_that_is_told() -> None:
    def fail_late(item: int) -> int:
        if item == 1:
            time.sleep(0.02)
        if item:
            raise ValueError(f"item {item}")
        return item

    before = names()
    with pytest.raises(ValueError, match="item 1"):
        map_in_workers(fail_late, [0, 1, 2, 3])
    assert names() <= before
