"""What README and documentation tell people to type can be typed.

Every command runs, page by page and one after the other, in a folder with
stand-ins for the files that they name; where it would take minutes, with
options that make it short. ``NOT_RUN`` has the few that cannot, each with
what is checked instead.
"""

import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from PIL import ImageGrab

from moka.cli.main import main
from tests.support.display import running_display
from tests.support.pages import PAGES, ROOT, command_lines, id_of, split
from tests.support.stand_ins import write_stand_ins

pytestmark = pytest.mark.gpu

DEADLINE_S = 120.0
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))

# Appended, so that an option of the page that is given again is overridden.
SHORTER = {
    "moka render": "--size 48x28",
    "moka view": "--size 320x240 --no-preferences",
    "moka bench accuracy": "--diameter 8 --truth-samples 512 --rounds 1 "
    "--environments sky.hdr",
    "moka bench cold": "--runs 1 --size 48x28",
    "moka bench frame": "--frames 2 --warm-up 1 --size 48x28",
    "moka bench scale": "--largest 1000 --widest 64 --frames 1",
    "moka bench versus": "--rounds 1",
    "python -m tests.support.stated_errors": "'tone_curve none'",
    "make demo": "ARGS='--size 48x28'",
    "make test": "ARGS='-p no:cacheprovider -q tests/core/test_signal.py'",
    "make bench": "ARGS='--runs 1 --warm-up 0'",
    # These take minutes, or write into the checkout.
    "make lint": "--dry-run",
    "make format": "--dry-run",
    "make gallery": "--dry-run",
}
# Within the words of another command.
SHORTER_BENCHMARK = "--frames 2 --warm-up 1 --size 48x28"


def check_requirement(words: list[str]) -> None:
    """What pip would install is this project with extras that it has."""
    _, install, *rest = words
    assert install == "install"
    named = [Requirement(word) for word in rest if not word.startswith("-")]
    assert named
    for requirement in named:
        assert requirement.name == PROJECT["project"]["name"]
        known = PROJECT["project"]["optional-dependencies"]
        assert requirement.extras <= set(known), requirement


def check_packages(words: list[str]) -> None:
    """What apt-get would install is what .ci/setup installs too."""
    _, action, *rest = words
    assert action in ("install", "update")
    setup = (ROOT / ".ci" / "setup").read_text("utf-8")
    for name in (word for word in rest if not word.startswith("-")):
        assert re.search(rf"echo .*\b{re.escape(name)}\b", setup), name


NOT_RUN: dict[str, Callable[[list[str]], None]] = {
    # They need the network and change the system.
    "apt-get": check_packages,
    "pip": check_requirement,
    # It empties a folder of the container that it is written for.
    "rm": lambda words: None,  # noqa: ARG005
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder and home, with everything that pages name.

    `moka` and `python` are those of this test, in a virtual environment that
    `make` finds set up already.
    """
    folder = tmp_path / "here"
    folder.mkdir()
    write_stand_ins(folder)
    for name in (
        *(".config/fish/completions", ".zfunc"),
        ".local/share/bash-completion/completions",
    ):
        (folder / name).mkdir(parents=True)
    tools = folder / ".venv" / "bin"
    tools.mkdir(parents=True)
    for name, module in (("moka", "-m moka"), ("python", "")):
        tool = tools / name
        tool.write_text(f'#!/bin/sh\nexec "{sys.executable}" {module} "$@"\n')
        tool.chmod(0o755)
    for stamp in (".dev", ".docs", ".bench"):
        (tools.parent / stamp).touch()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("HOME", str(folder))
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    return folder


def shortened(command: str) -> str:
    """The command with options that make it short."""
    command = command.partition(" #")[0].strip()
    shorter = next(
        (SHORTER[each] for each in SHORTER if command.startswith(each)), ""
    )
    if re.search("--(frames|turntable)", command):
        shorter += " --frames 2"
    command = re.sub(r"'(frame .*?)'", rf"'\1 {SHORTER_BENCHMARK}'", command)
    return f"{command} {shorter}"


def run(command: str) -> None:
    """Run it as a shell would; here where it needs none, which is faster."""
    words = split(command)
    if shutil.which(words[0]) is None:
        pytest.skip(f"there is no {words[0]}")
    if words[0] == "moka" and not re.search(r"[|>*]", command):
        assert main(words[1:]) == 0, command
        return
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


def test_no_exception_is_left_over() -> None:
    """A list of exceptions grows unless somebody looks."""
    commands = [each for path in PAGES for each, _ in command_lines(path)]
    for beginning in (*SHORTER, *NOT_RUN):
        assert any(
            each.removeprefix("sudo ").startswith(beginning)
            for each in commands
        ), beginning


@pytest.mark.parametrize(
    "path", [path for path in PAGES if any(command_lines(path))], ids=id_of
)
@pytest.mark.usefixtures("folder")
def test_commands_run(path: Path) -> None:
    for command, before in command_lines(path):
        exec(before, {})
        command = command.removeprefix("sudo ")
        words = split(command)
        if words[0] in NOT_RUN:
            NOT_RUN[words[0]](words)
        elif not command.startswith("moka view"):
            run(shortened(command))


@pytest.mark.parametrize(
    "command",
    sorted(
        {
            command.partition(" #")[0].strip()
            for path in PAGES
            for command, _ in command_lines(path)
            if command.startswith("moka view")
        }
    ),
)
@pytest.mark.usefixtures("folder")
@pytest.mark.window
def test_windows_open(command: str) -> None:
    """Until there is a picture; a person who closes it ends the command."""
    pytest.importorskip("imgui_bundle")
    if shutil.which("xdotool") is None:
        pytest.skip("there is no xdotool")
    with (
        running_display() as display,
        subprocess.Popen(split(shortened(command))) as viewer,
    ):
        try:
            deadline = time.monotonic() + DEADLINE_S
            while True:
                assert time.monotonic() < deadline, "there is no picture"
                assert viewer.poll() is None
                time.sleep(0.05)
                # In the middle of what the panels leave.
                box = (20, 60, 100, 180)
                seen = ImageGrab.grab(box, xdisplay=display).convert("RGB")
                if len(np.unique(np.asarray(seen).reshape(-1, 3), axis=0)) > 50:
                    break
            escape = ["xdotool", "mousemove", "60", "100", "key", "Escape"]
            subprocess.run(escape, check=True, timeout=DEADLINE_S)
            assert viewer.wait(DEADLINE_S) == 0
        finally:
            viewer.kill()


def test_recipes_are_for_a_python_that_the_project_takes() -> None:
    supported = SpecifierSet(PROJECT["project"]["requires-python"])
    text = (ROOT / "docs" / "install.md").read_text("utf-8")
    found = re.findall(r'python(?::|-version: ")(\d\.\d+)', text)
    assert len(found) == 3
    assert all(version in supported for version in found)
    (started,) = re.findall(r'^ENTRYPOINT \["(.*)"\]$', text, re.MULTILINE)
    assert started in PROJECT["project"]["scripts"]


def test_ci_does_what_pages_tell_people_to_do() -> None:
    """Also those targets of `make` that are not run above."""

    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text("utf-8")
    steps = yaml.safe_load(workflow)["jobs"]["check"]["steps"]
    assert [each["run"] for each in steps if "run" in each] == [".ci/run"]
    script = ROOT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    made = re.findall(r"^make (\w+)$", script.read_text("utf-8"), re.MULTILINE)
    assert set(made) == {"demo", "lint", "types", "docs", "test"}
