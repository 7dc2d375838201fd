"""moka bench accuracy: the sweep, its means, its outputs, its faults."""

import json
import math
from pathlib import Path

import pytest

from moka.bench.accuracy_plot import plot_accuracy
from moka.bench.accuracy_results import (
    UnderEnvironment,
    as_json,
    format_results,
    mean_points,
)
from moka.bench.lighting_measure import Measurement
from moka.bench.lighting_modes import lighting_modes
from moka.bench.sphere_errors import SphereErrors
from moka.bench.spheres import MATERIALS, SphereGrid
from moka.cli import main
from moka.renderer.quality import QUALITIES
from moka.renderer.settings import RenderSettings

MODES = lighting_modes(RenderSettings(samples=1), quick=True)


def made_up(scale: float) -> UnderEnvironment:
    """Errors fall and times grow from mode to mode."""
    measurements = tuple(
        Measurement(
            mode,
            SphereErrors(scale / number, 0.5 / number, 0.0, 1.0, 0.0, None),
            10.0,
            float(number),
        )
        for number, mode in enumerate(MODES, 1)
    )
    return UnderEnvironment(f"folder/{scale:g}.hdr", 4096, measurements)


RESULTS = [made_up(1.0), made_up(3.0)]


@pytest.mark.parametrize("quick", [True, False])
def test_the_sweep_has_every_mode_and_every_quality(quick: bool) -> None:
    modes = lighting_modes(RenderSettings(samples=1), quick=quick)
    assert {mode.family for mode in modes} == {
        "split-sum",
        "filtered",
        "reference",
    }
    named = [mode.quality for mode in modes if mode.quality]
    assert sorted(named) == sorted(QUALITIES)
    assert len({mode.name for mode in modes}) == len(modes)
    assert all(mode.settings.samples == 1 for mode in modes)


def test_a_picture_of_reference_lighting_takes_many_frames() -> None:
    frames = {mode.name: mode.frames for mode in MODES}
    assert frames["split-sum"] == frames["filtered 32"] == 1
    assert frames["reference 256"] > 1


def test_points_are_means_over_environments() -> None:
    points = mean_points(RESULTS)
    assert [point.mode for point in points] == list(MODES)
    assert points[1].relative_rmse == pytest.approx((1 / 2 + 3 / 2) / 2)
    assert points[1].first_ms == pytest.approx(12.0)
    assert all(point.picture_front for point in points)


def test_the_error_of_the_truth_follows_from_that_of_fewer_samples() -> None:
    last = RESULTS[0].measurements[-1]
    assert last.mode.name == "reference 256"
    assert RESULTS[0].truth_error == pytest.approx(
        last.errors.relative_rmse / 4
    )


def test_the_table_and_the_file_say_the_same() -> None:
    grid = SphereGrid(MATERIALS, (0.0, 1.0), 8)
    written = json.loads(json.dumps(as_json(grid, RESULTS)))
    text = format_results(RESULTS)
    assert list(written["environments"]) == ["1", "3"]
    for mode in MODES:
        assert mode.name in text
        assert mode.name in written["mean"]
    assert written["mean"]["split-sum"]["quality"] == "balanced"
    assert written["mean"]["filtered 8"]["settings"]["ibl_samples"] == 8
    assert written["environments"]["3"]["modes"]["split-sum"]["flip"] is None


def test_the_chart_is_a_picture(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / "chart.png"
    plot_accuracy(RESULTS, path)
    assert path.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--diameter", "7"], "--diameter: 7 is not an even number"),
        (["--rounds", "0"], "is not 1, 2, 3"),
        (["--plot", "chart.jpg"], "chart.jpg: a plot needs the ending .png"),
        (["--truth-samples", "511"], "511 are no truth for a mode of 256"),
        (["--environments", "none"], "--environments none: without light"),
        (["--environments", "missing.hdr"], "missing.hdr: "),
    ],
)
def test_a_mistake_is_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert main(["bench", "accuracy", "--quick", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.gpu
def test_modes_agree_where_all_are_exact(tmp_path: Path) -> None:
    """Under uniform light, with the energy compensation that fits it."""
    path = tmp_path / "accuracy.json"
    command = ["bench", "accuracy", "--quick", "--diameter", "8"]
    command += ["--environments", "furnace", "--multiscatter", "on"]
    command += ["--truth-samples", "512", "--rounds", "1"]
    assert main([*command, "--json", str(path)]) == 0
    modes = json.loads(path.read_text())["environments"]["furnace"]["modes"]
    assert len(modes) == len(MODES)
    for name, found in modes.items():
        mode, _, samples = name.partition(" ")
        noise = 0.5 / math.sqrt(int(samples)) if mode == "reference" else 0.0
        assert found["relative_rmse"] < 0.02 + noise, name
        assert abs(found["bias"]) < 0.01, name
        assert found["picture_ms"] > 0.0
