"""The command line as a whole: help, versions, unknown words."""

import importlib
import os
import subprocess
import sys

import pytest

from moka.cli import main
from moka.cli.main import _COMMANDS
from moka.version import __version__


def test_every_command_says_what_its_module_says() -> None:
    for name, summary in _COMMANDS.items():
        module = importlib.import_module(f"moka.cli.{name}")
        assert module.__doc__ is not None
        assert module.__doc__.splitlines()[0] == summary
        assert callable(module.add_arguments)
        assert callable(module.execute)


@pytest.mark.parametrize("arguments", [["--help"], ["render", "--help"]])
def test_help_goes_to_standard_output(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 0
    assert "render" in capsys.readouterr().out


def test_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"moka {__version__}\n"


@pytest.mark.parametrize("arguments", [[], ["paint"], ["--paint"]])
def test_an_unknown_command_is_one_line(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith("moka: error: ")
    assert error.count("\n") == 1


def test_a_command_loads_nothing_of_the_others() -> None:
    """Nor does help load NumPy."""
    code = (
        "import sys\n"
        "from moka.cli import main\n"
        "try:\n    main(sys.argv[1:])\nexcept SystemExit:\n    pass\n"
        "print(*sorted(sys.modules))"
    )
    for arguments, absent in (
        (["--help"], {"numpy", "moka.cli.render", "moka.cli.doctor"}),
        (["render", "--help"], {"numpy", "moka.cli.doctor", "moka.cli.info"}),
        # argparse asks for it where it wants to know the terminal's width.
        (["render", "missing.glb"], {"shutil"}),
    ):
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments],
            capture_output=True,
            text=True,
            check=True,
        )
        assert not absent & set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("call", "is_own"),
    [("main()", True), ("main(sys.argv[1:])", False)],
)
def test_a_picture_of_its_own_process_is_not_interrupted_to_collect(
    call: str, is_own: bool
) -> None:
    code = (
        "import gc, sys\n"
        "from moka.cli import main\n"
        "before = gc.get_threshold()[0]\n"
        f"try:\n    {call}\nexcept SystemExit:\n    pass\n"
        "print(before, gc.get_threshold()[0])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, "render", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    before, after = map(int, result.stdout.splitlines()[-1].split())
    assert after >= 100 * before if is_own else after == before


def test_help_is_as_wide_as_the_terminal() -> None:
    widths = []
    for columns in ("50", "100"):
        result = subprocess.run(
            [sys.executable, "-m", "moka", "render", "--help"],
            env={**os.environ, "COLUMNS": columns},
            capture_output=True,
            text=True,
            check=True,
        )
        widths.append(max(map(len, result.stdout.splitlines())))
    assert widths[0] < 60 < 80 < widths[1] < 100
