"""Which rows of a tree are seen."""

import time

import numpy as np
import pytest

from moka.ui.tree_rows import TreeRows

# 0 ── 1 ── 3        2 ── 5
#      └─── 4
PARENTS = [-1, 0, -1, 1, 1, 2]
NAMES = ["car", "Wheel", "driver", "tyre", "hub of a wheel", "hat"]


def test_what_is_open_is_seen_depth_first() -> None:
    rows = TreeRows(PARENTS, NAMES)
    assert len(rows) == 6
    assert rows.seen == [0, 2]
    rows.toggle(0)
    assert rows.seen == [0, 1, 2]
    rows.toggle(1)
    assert rows.seen == [0, 1, 3, 4, 2]
    rows.toggle(2)
    assert rows.seen == [0, 1, 3, 4, 2, 5]
    rows.toggle(0)
    assert rows.seen == [0, 2, 5]
    rows.toggle(0)
    assert rows.seen == [0, 1, 3, 4, 2, 5]  # What was open below still is.
    assert rows.depth.tolist() == [0, 1, 0, 2, 2, 1]
    assert [rows.has_children(row) for row in range(6)] == [
        *(True, True, True),
        *(False, False, False),
    ]


def test_what_is_revealed_is_seen() -> None:
    rows = TreeRows(PARENTS, NAMES)
    rows.reveal(4)
    assert rows.seen == [0, 1, 3, 4, 2]
    assert rows.is_open(1)
    assert not rows.is_open(2)


def test_a_search_finds_names_wherever_they_are() -> None:
    rows = TreeRows(PARENTS, NAMES)
    rows.search = "WHEEL"
    assert rows.seen == [1, 4]
    rows.search = "nothing"
    assert rows.seen == []
    rows.search = ""
    assert rows.seen == [0, 2]


def test_nothing_is_a_tree_too() -> None:
    assert TreeRows([], []).seen == []


@pytest.mark.parametrize("shape", ["flat", "chain", "bushy"])
def test_a_hundred_thousand_nodes_cost_a_frame_nothing(shape: str) -> None:
    """They are listed when something opens, and then kept."""
    count = 100_000
    parents = {
        "flat": np.full(count, -1),
        "chain": np.arange(count) - 1,
        "bushy": (np.arange(count) - 1) // 10,
    }[shape]
    rows = TreeRows(parents, [f"node {row}" for row in range(count)])
    rows.reveal(count - 1)
    assert rows.seen[0] == 0
    assert (
        rows.depth.max() == {"flat": 0, "chain": count - 1, "bushy": 5}[shape]
    )
    seen = rows.seen
    start = time.perf_counter()
    for _ in range(1000):
        assert rows.seen is seen
    assert time.perf_counter() - start < 0.1
    rows.search = "node 9999"
    assert len(rows.seen) == 11
