"""``moka bench frame``: its file, its options, what it counts."""

import json
import sys
from pathlib import Path

import pytest

from moka.cli.main import main
from moka.model.assemble import model_of
from moka.model.geometry import cube
from moka.model.save import save_model


@pytest.mark.gpu
def test_the_file_has_exactly_what_was_promised(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model, out = tmp_path / "cube.glb", tmp_path / "frame.json"
    place = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    save_model(model_of([(cube(), None, place)]), model)
    options = "--frames 3 --size 32x24 --warm-up 1 --yaw-per-frame 30"
    arguments = ["bench", "frame", str(model), *options.split()]
    arguments += ["--environment", "furnace", "--json", str(out)]
    assert main(arguments) == 0
    found = json.loads(out.read_text())
    assert set(found) == {"frame_ms", "counts"}
    times = found["frame_ms"]
    assert set(times) == {"median", "p95", "submit_median"}
    assert 0 < times["submit_median"] < times["median"] <= times["p95"]
    assert found["counts"]["objects"] == found["counts"]["visible"] == 1
    assert found["counts"]["gl_draws"] >= 1
    assert "median" in capsys.readouterr().out


RIVAL = """
import sys
print("ready")
for line in sys.stdin:
    print(1000.0, 2000.0, flush=True)
"""


@pytest.mark.gpu
def test_another_program_takes_turns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script, out = tmp_path / "rival.py", tmp_path / "frame.json"
    script.write_text(RIVAL)
    arguments = ["bench", "frame", "--frames=3", "--size=16x16"]
    arguments += ["--environment=none", "--json", str(out)]
    arguments += [f"--against={sys.executable} {script}"]
    assert main(arguments) == 0
    found = json.loads(out.read_text())
    ratio = found["against"]["frame"]
    assert ratio["low"] <= ratio["ratio"] <= ratio["high"]
    expected = found["frame_ms"]["median"] / 1000.0
    assert ratio["ratio"] == pytest.approx(expected, abs=1e-4)
    assert found["against"]["cpu"]["ratio"] > 0
    assert "rival.py" in capsys.readouterr().out


@pytest.mark.gpu
def test_a_program_that_ends_is_an_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = ["bench", "frame", "--size=16x16", "--environment=none"]
    arguments += [f"--against={sys.executable} -c 'raise SystemExit(3)'"]
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "ended with exit code 3" in said


@pytest.mark.parametrize(
    "option", ["--frames=0", "--size=12", "--yaw-per-frame=nan"]
)
def test_a_wrong_option_is_one_line(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "frame", option]) == 2
    assert capsys.readouterr().err.count("\n") == 1
