"""``moka bench frame``: its file, its options, what it counts."""

import json
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


@pytest.mark.parametrize(
    "option", ["--frames=0", "--size=12", "--yaw-per-frame=nan"]
)
def test_a_wrong_option_is_one_line(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "frame", option]) == 2
    assert capsys.readouterr().err.count("\n") == 1
