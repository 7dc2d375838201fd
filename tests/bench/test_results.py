"""Tables, JSON files and plots of results."""

import builtins
import json
from pathlib import Path
from typing import Any

import pytest

from moka.bench.plot import plot_growth, plot_histogram
from moka.bench.results import check_output, format_table, write_json
from moka.core.errors import OptionError


def test_a_table_is_aligned() -> None:
    table = format_table(["n", "ms"], [["a", 1.23456], ["bcd", 1234.5]])
    assert table == "n      ms\na    1.23\nbcd  1234"


def test_json_is_written_whole(tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    write_json({"a": [1, 2.5]}, path)
    assert json.loads(path.read_text()) == {"a": [1, 2.5]}
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        (("missing/r.json", None), "folder missing is missing"),
        ((None, "missing/r.png"), "folder missing is missing"),
        ((None, "r.gif"), "needs the ending .png, .svg, .pdf"),
    ],
)
def test_outputs_are_checked_before_the_work(
    outputs: tuple[str | None, str | None], message: str
) -> None:
    with pytest.raises(OptionError, match=message):
        check_output(*(path and Path(path) for path in outputs))


def test_plots_are_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    one, two = tmp_path / "one.svg", tmp_path / "two.svg"
    plot_histogram({"frame": [1.0, 2.0, 2.5]}, one)
    plot_growth(
        {"objects": [(10, 1.0, 0.9, 1.2), (100, 2.0, 1.9, 2.2)]}, "count", two
    )
    assert "<svg" in one.read_text()
    assert "<svg" in two.read_text()


def test_a_plot_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **named: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return real(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(OptionError, match=r"pip install 'moka-pbr\[bench\]'"):
        plot_histogram({"frame": [1.0]}, tmp_path / "one.png")
