"""``moka bench versus``: two option sets, two checkouts."""

import json
from pathlib import Path

import pytest

from moka.bench.versus import medians
from moka.cli.main import main

FRAME = "frame --size 16x16 --frames 2 --warm-up 1 --environment furnace"


def test_medians_are_found_by_their_path() -> None:
    result = {
        "frame_ms": {"median": 4.0, "p95": 5.0, "submit_median": 1.0},
        "points": [{"ms": {"median": 2}}, {"ms": {"median": 0.0}}],
        "median": 7.0,
        "counts": {"objects": 3},
    }
    assert dict(medians(result)) == {
        "frame_ms": 4.0,
        "frame_ms.submit_median": 1.0,
        "points.0.ms": 2.0,
        "median": 7.0,
    }


@pytest.mark.gpu
def test_two_option_sets(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "versus.json"
    arguments = ["bench", "versus", FRAME, f"{FRAME} --samples 1"]
    assert main([*arguments, "--rounds", "1", "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert set(found["medians"]) == {"frame_ms", "frame_ms.submit_median"}
    frame = found["medians"]["frame_ms"]
    assert frame["ratio"] == pytest.approx(frame["b"] / frame["a"], abs=1e-3)
    assert "B / A" in capsys.readouterr().out


@pytest.mark.gpu
def test_a_checkout_runs_its_own_moka(tmp_path: Path) -> None:
    package = tmp_path / "moka"
    package.mkdir()
    (package / "__init__.py").touch()
    # Answers in the stead of the command line.
    (package / "__main__.py").write_text(
        "import sys, json\n"
        "path = sys.argv[sys.argv.index('--json') + 1]\n"
        "found = {'frame_ms': {'median': 1e6}}\n"
        "open(path, 'w').write(json.dumps(found))\n"
    )
    out = tmp_path / "versus.json"
    arguments = ["bench", "versus", FRAME, "--checkout", str(tmp_path)]
    assert main([*arguments, "--rounds", "1", "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert list(found["medians"]) == ["frame_ms"]
    assert found["medians"]["frame_ms"]["b"] == 1e6
    assert found["medians"]["frame_ms"]["ratio"] > 100


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["frame"], "needs B or --checkout"),
        (["frame", "--checkout", "nowhere"], "holds no folder moka"),
        (["frame", "frame", "--plot", "a.png"], "draws nothing"),
        (["nonsense", "nonsense", "--rounds", "1"], "nonsense"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "versus", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message in error
