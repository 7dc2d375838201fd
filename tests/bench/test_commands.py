"""``moka bench commands``: the work is what it says, and is measured."""

import json
from pathlib import Path

import pytest

from moka.bench.draw_work import DrawWork
from moka.bench.measure import milliseconds_in_turn
from moka.cli.main import main


def test_draws_are_merged_as_far_as_their_order_allows() -> None:
    with DrawWork(5000) as work:
        for step in (work.record, work.record_by_hand, work.sort, work.merge):
            step()
        work.submit()
        counts = work.counts
    assert counts["draw_packets"] == 5000
    # Sorted, every pair of a program and a material is one batch.
    assert counts["gl_draws"] <= 8 * 64
    assert counts["gl_draws"] < counts["commands"] < 5000


def test_a_file_of_two_sizes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "commands.json"
    arguments = ["bench", "commands", "--draws", "10,20", "--runs", "2"]
    assert main([*arguments, "--json", str(out)]) == 0
    points = json.loads(out.read_text())["points"]
    assert [point["draws"] for point in points] == [10, 20]
    for point in points:
        for step in ("by_hand", "record", "sort", "merge", "submit"):
            assert point[f"{step}_ms"]["count"] == 2
    assert "draws, median ms" in capsys.readouterr().out


def test_jobs_take_turns_and_the_first_round_is_not_counted() -> None:
    calls: list[str] = []
    times = milliseconds_in_turn(
        {name: lambda name=name: calls.append(name) for name in "ab"}, 3
    )
    assert "".join(calls) == "abababab"
    assert times["a"]["count"] == times["b"]["count"] == 3
