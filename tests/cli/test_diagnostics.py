"""``--verbose``, ``--quiet``, and what a terminal gets to see."""

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from moka.cli.main import _COMMANDS, _parser, main
from tests.model.files import TRIANGLE, TRIANGLE_BINARY, glb

SMALL = ["--size", "16x9", "--no-cache", "--environment", "furnace"]


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A triangle that asks for what moka does not know."""
    document = {**TRIANGLE, "extensionsUsed": ["EXT_unheard_of"]}
    path = tmp_path / "model.glb"
    path.write_bytes(glb(document, TRIANGLE_BINARY))
    return path


def render(model: Path, *options: str) -> int:
    output = str(model.with_suffix(".png"))
    return main(["render", str(model), *SMALL, "-o", output, *options])


@pytest.mark.gpu
def test_warnings_are_lines_on_standard_error(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert render(model) == 0
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == (
        f"moka: warning: {model}: is drawn without 'EXT_unheard_of', see "
        "moka info\n"
    )


@pytest.mark.gpu
def test_quiet_says_nothing_but_errors(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert render(model, "--quiet") == 0
    assert capsys.readouterr().err == ""
    assert render(model, "--quiet", "--camera", "nobody") == 2
    assert capsys.readouterr().err.startswith("moka: error: ")


@pytest.mark.gpu
def test_verbose_tells_what_is_read_and_chosen(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert render(model, "--verbose") == 0
    lines = capsys.readouterr().err.splitlines()
    assert f"moka: info: {model}: read, 1 nodes, 1 meshes" in "\n".join(lines)
    assert any("OpenGL" in line for line in lines)
    assert all(
        line.startswith(("moka: info: ", "moka: warning: ")) for line in lines
    )


@pytest.mark.gpu
def test_twice_verbose_goes_into_detail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = str(tmp_path / "demo.png")
    assert main(["render", *SMALL, "-vv", "-o", output]) == 0
    assert "finer than the picture can show" in capsys.readouterr().err
    assert main(["render", *SMALL, "-v", "-o", output]) == 0
    assert "debug" not in capsys.readouterr().err


def test_logging_is_afterwards_as_it_was(tmp_path: Path) -> None:
    logger = logging.getLogger("moka")
    before = logger.level, list(logger.handlers)
    assert main(["info", str(tmp_path / "nothing.glb"), "-vv"]) == 2
    assert (logger.level, list(logger.handlers)) == before


@pytest.mark.parametrize("name", [*_COMMANDS])
def test_every_command_has_the_options(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([name, "--help"])
    text = capsys.readouterr().out
    for option in ("--debug", "--verbose", "--quiet"):
        assert option in text


def test_nested_commands_have_them_on_either_side() -> None:
    for words, verbose in (
        (["bench", "commands"], 0),
        (["bench", "-v", "commands"], 1),
        (["bench", "commands", "-vv"], 2),
    ):
        parsed = _parser(words).parse_args(words)
        assert (parsed.verbose, parsed.quiet) == (verbose, False)


def test_verbose_and_quiet_exclude_each_other(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["render", "-v", "-q"]) == 2
    assert "not allowed with" in capsys.readouterr().err


@pytest.mark.gpu
def test_python_has_nothing_to_warn_of_and_there_is_no_colour(
    model: Path,
) -> None:
    """Also where a terminal could show it, if NO_COLOR is set."""
    environment = {**os.environ, "NO_COLOR": "1", "TERM": "xterm-256color"}
    for words in (
        ["--help"],
        ["info", str(model)],
        ["render", str(model), *SMALL, "-v", "-o", str(model) + ".png"],
        ["render", "nothing.glb"],
    ):
        done = subprocess.run(
            [sys.executable, "-W", "error", "-m", "moka", *words],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == (2 if "nothing.glb" in words else 0)
        assert "\x1b" not in done.stdout + done.stderr
        assert "Warning" not in done.stderr


@pytest.mark.parametrize("name", ["", *_COMMANDS])
def test_help_fits_a_terminal_of_80_columns(
    name: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        main([name, "--help"] if name else ["--help"])
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
