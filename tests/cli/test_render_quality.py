"""moka render --quality: named lighting, and the options that change it."""

import json
from pathlib import Path

import pytest

from moka.cli import main


def test_an_unknown_quality_is_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["render", "--quality", "ultra"]) == 2
    assert capsys.readouterr().err == (
        "moka: error: quality: 'ultra' is unknown; choose from fast, "
        "balanced, best\n"
    )


def test_an_option_has_to_fit_the_quality(
    capsys: pytest.CaptureFixture[str],
) -> None:
    command = ["render", "--quality", "fast", "--ibl-samples", "8"]
    assert main(command) == 2
    assert "--ibl-samples: needs --ibl filtered" in capsys.readouterr().err


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (
            ["--quality", "fast", "--environment", "studio"],
            ("split-sum", "sh", 0),
        ),
        (
            ["--quality", "best", "--ibl-samples", "5"],
            ("filtered", "cube", 5),
        ),
        (
            ["--quality", "best", "--ibl", "split-sum", "--irradiance", "sh"],
            ("split-sum", "sh", 0),
        ),
    ],
)
def test_a_quality_decides_what_no_option_does(
    tmp_path: Path, options: list[str], expected: tuple[str, str, int]
) -> None:
    statistics = tmp_path / "a.json"
    command = ["render", "--size", "16x12", "--no-cache", *options]
    command += ["-o", str(tmp_path / "a.png"), "--stats", str(statistics)]
    assert main(command) == 0
    lighting = json.loads(statistics.read_text())["lighting"]
    found = tuple(
        lighting[name] for name in ("mode", "irradiance", "samples_per_pixel")
    )
    assert found == expected
