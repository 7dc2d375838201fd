"""moka render --suns and --irradiance."""

import json
from pathlib import Path

import pytest

from moka.cli import main


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--suns", "bright"], "'bright' is not auto, off or 1, 2"),
        (["--suns", "-1"], "'-1' is not auto, off or 1, 2"),
        (["--suns", "1000"], "1000 is neither auto, off nor 0 to 64"),
        (["--irradiance", "map"], "'map' is unknown; choose from auto, sh"),
    ],
)
def test_a_bad_option_is_named(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    arguments: list[str],
    message: str,
) -> None:
    output = tmp_path / "out.png"
    assert main(["render", *arguments, "-o", str(output)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not output.exists()


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("environment", "arguments", "suns", "irradiance"),
    [
        ("sky", [], 1, "sh"),
        ("sky", ["--suns", "off"], 0, "sh"),
        ("sky", ["--suns", "2", "--irradiance", "cube"], 1, "cube"),
        ("studio", [], 0, "cube"),
        ("furnace", [], 0, "sh"),
        ("none", [], 0, None),
    ],
)
def test_statistics_say_how_the_environment_lights(
    tmp_path: Path,
    environment: str,
    arguments: list[str],
    suns: int,
    irradiance: str | None,
) -> None:
    output, statistics = tmp_path / "out.png", tmp_path / "out.json"
    command = ["render", "--size", "16x16", "--samples", "1"]
    command += ["--environment", environment, *arguments]
    command += ["-o", str(output), "--stats", str(statistics)]
    assert main(command) == 0
    lighting = json.loads(statistics.read_text())["lighting"]
    assert lighting["mode"] == "split-sum"
    assert lighting["suns"] == suns
    assert lighting["irradiance"] == irradiance
    assert lighting["cached"] is False
    assert lighting["estimated_error"] is None
