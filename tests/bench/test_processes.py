"""Processes in turn: what is measured and what a failure says."""

import os
import sys

import pytest

from moka.bench.processes import ProcessRun, in_turn, run_process
from moka.core.errors import MokaError


def test_a_process_is_measured_and_gets_its_environment() -> None:
    script = (
        "import os; assert os.environ['FRUIT'] == 'plum'; sum(range(10**6))"
    )
    run = run_process([sys.executable, "-c", script], {"FRUIT": "plum"})
    assert run.wall_ms > 1
    if hasattr(os, "wait4"):
        assert run.cpu_ms is not None
        assert run.peak_rss_mb is not None
        assert run.cpu_ms > 1
        assert run.peak_rss_mb > 2


def test_a_failure_says_its_last_line() -> None:
    script = "print('first'); raise SystemExit('it broke')"
    with pytest.raises(MokaError, match=r"exit code 1: it broke$"):
        run_process([sys.executable, "-c", script])


def test_a_missing_program_is_named() -> None:
    with pytest.raises(MokaError, match="no-such-program: cannot be run"):
        run_process(["no-such-program"])


def test_jobs_take_turns_after_a_warm_up() -> None:
    calls: list[str] = []

    def job(name: str) -> ProcessRun:
        calls.append(name)
        return ProcessRun(float(len(calls)))

    runs = in_turn({"a": lambda: job("a"), "b": lambda: job("b")}, 2)
    assert "".join(calls) == "ababab"
    assert [run.wall_ms for run in runs["a"]] == [3, 5]
    assert [run.wall_ms for run in runs["b"]] == [4, 6]
