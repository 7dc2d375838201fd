"""moka render --ibl: its options, its statistics, its faults."""

import json
from pathlib import Path

import numpy as np
import pytest

from moka.cli import main
from moka.core.exr import read_exr


def fail(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line that a failing command prints."""
    assert main(["render", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("moka: error: ")
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--ibl", "magic"], "'magic' is unknown; choose from split-sum"),
        (["--ibl-samples", "8"], "--ibl-samples: needs --ibl filtered"),
        (
            ["--ibl", "reference", "--ibl-samples", "8"],
            "--ibl-samples: needs --ibl filtered",
        ),
        (["--max-error", "0.1"], "--max-error: needs --ibl reference"),
        (
            ["--ibl", "filtered", "--reference-samples", "8"],
            "--reference-samples: needs --ibl reference",
        ),
        (["--ibl", "reference", "--max-error", "0"], "not between 0 and 1"),
        (["--ibl", "reference", "--max-error", "few"], "not a number"),
        (["--ibl", "filtered", "--ibl-samples", "0"], "is not 1, 2, 3"),
        (["--ibl", "filtered", "--ibl-samples", "999"], "between 1 and 256"),
        (["--ibl", "reference", "--suns", "2"], "--suns: --ibl reference"),
        (
            ["--ibl", "reference", "--irradiance", "sh"],
            "--irradiance: --ibl reference",
        ),
        (
            ["--ibl", "reference", "--reflections", "half"],
            "--reflections: --ibl reference",
        ),
        (["--reflections", "tiny"], "'tiny' is unknown; choose from full"),
    ],
)
def test_options_that_do_not_fit_are_named(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    arguments: list[str],
    message: str,
) -> None:
    output = tmp_path / "never.png"
    assert message in fail(capsys, *arguments, "-o", str(output))
    assert not output.exists()


@pytest.mark.gpu
def test_reference_stops_at_an_error_and_says_so(tmp_path: Path) -> None:
    picture, statistics = tmp_path / "a.exr", tmp_path / "a.json"
    command = ["render", "--ibl", "reference", "--max-error", "0.1"]
    command += ["--size", "64x48", "--environment", "sky"]
    command += ["-o", str(picture), "--stats", str(statistics)]
    assert main(command) == 0
    lighting = json.loads(statistics.read_text())["lighting"]
    assert lighting["mode"] == "reference"
    assert lighting["estimated_error"] <= 0.1
    assert lighting["samples_per_pixel"] >= 128
    pixels, _ = read_exr(picture)
    assert pixels.shape[:2] == (48, 64)
    assert np.isfinite(pixels).all()


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("mode", "samples"), [("split-sum", 0), ("filtered", 16)]
)
def test_other_modes_estimate_no_error(
    tmp_path: Path, mode: str, samples: int
) -> None:
    statistics = tmp_path / "a.json"
    command = ["render", "--ibl", mode, "--size", "32x24"]
    command += ["-o", str(tmp_path / "a.png"), "--stats", str(statistics)]
    assert main(command) == 0
    lighting = json.loads(statistics.read_text())["lighting"]
    assert lighting["mode"] == mode
    assert lighting["samples_per_pixel"] == samples
    assert lighting["estimated_error"] is None
