"""``moka completion``: scripts that shells understand, from the parsers."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from moka.cli.completion import SHELLS
from moka.cli.main import _COMMANDS, _parser, main
from moka.cli.picture_options import picture_request

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def bash() -> str:
    found = shutil.which("bash")
    if found is None:
        pytest.skip("bash is not installed")
    return found


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    pytest.importorskip("shtab", reason="shtab is not installed")
    assert main(["completion", shell]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


@pytest.mark.parametrize("shell", SHELLS)
def test_a_script_knows_all_commands(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = script(shell, capsys)
    for word in (*_COMMANDS, "reference-samples", "tone-map", "analyse"):
        assert word in text


@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_reads_it_without_complaint(
    shell: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    program = shutil.which(shell)
    if program is None:
        pytest.skip(f"{shell} is not installed")
    path = tmp_path / f"moka.{shell}"
    path.write_text(script(shell, capsys))
    done = subprocess.run(
        [program, "-n", str(path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("moka re", {"render"}),
        ("moka bench sc", {"scale"}),
        ("moka render --tone-map ag", {"agx"}),
        ("moka render --env", {f"--environment{each}" for each in (
            "", "-rotation", "-intensity",
        )}),
        ("moka render hel", {"helmet.glb"}),
        ("moka render --environment sun", {"sunset.hdr"}),
        ("moka compare picture.png pic", {"picture.png"}),
        ("moka cache cl", {"clear"}),
    ],
)  # fmt: skip
def test_bash_completes(
    typed: str,
    offered: set[str],
    bash: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    for name in ("helmet.glb", "sunset.hdr", "picture.png"):
        (tmp_path / name).touch()
    words = typed.split()
    question = (
        f"COMP_WORDS=({typed}); COMP_CWORD={len(words) - 1}\n"
        f"_shtab_moka moka {words[-1]} {words[-2]}\n"
        'printf "%s\\n" "${COMPREPLY[@]}"\n'
    )
    done = subprocess.run(
        [bash, "--norc", "-c", script("bash", capsys) + question],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert {line.strip() for line in done.stdout.splitlines()} == offered


def test_without_shtab_one_line_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2
    assert capsys.readouterr().err == (
        "moka: error: completion needs the package shtab: "
        "pip install 'moka-pbr[completion]'\n"
    )


def test_names_that_are_offered_are_taken() -> None:
    from moka.cli.completion import _values

    for option, names in _values().items():
        for name in names:
            words = ["render", f"--{option.replace('_', '-')}", name]
            request = picture_request(_parser(words).parse_args(words))
            assert request.settings is not None
