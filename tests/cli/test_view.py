"""``moka view`` as a process, with somebody in front of it."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import ImageGrab

from moka.material.material import Material
from moka.model import cube, model_of, save_model
from tests.support.display import running_display

pytest.importorskip("imgui_bundle")
pytest.importorskip("glfw")
pytestmark = [pytest.mark.window, pytest.mark.gpu]

WAIT_S = 60.0


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    with running_display() as name:
        yield name


def act(commands: str) -> str:
    if shutil.which("xdotool") is None:
        pytest.skip("there is no xdotool")
    return subprocess.run(
        ["xdotool", *commands.split()],
        capture_output=True,
        text=True,
        timeout=WAIT_S,
        check=False,
    ).stdout


def wait_for(what: str, condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < deadline, f"{what} did not happen"
        time.sleep(0.05)


def reds(display: str, size: tuple[int, int]) -> int:
    """How many pixels of the screen's upper left are red."""
    image = ImageGrab.grab(bbox=(0, 0, *size), xdisplay=display)
    red, green, blue = np.moveaxis(np.asarray(image.convert("RGB"), int), 2, 0)
    return int(((red > 150) & (red > green + 60) & (red > blue + 60)).sum())


def test_it_opens_resizes_and_ends_well(display: str, tmp_path: Path) -> None:
    material = Material(
        base_colour_factor=(1, 0.1, 0.05, 1), metallic_factor=0.0
    )
    path = tmp_path / "cube.glb"
    save_model(model_of([(cube(1.0), material, np.eye(4))]), path)
    command = [
        *(sys.executable, "-m", "moka", "view", str(path)),
        *("--environment", "furnace", "--size", "400x300"),
        *("--no-cache", "--no-preferences"),
    ]
    with subprocess.Popen(
        command,
        env={**os.environ, "DISPLAY": display},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as viewer:
        try:
            wait_for("a picture", lambda: reds(display, (400, 300)) > 100)
            small = reds(display, (400, 300))
            act("search --name moka windowsize 640 480")
            wait_for(
                "a larger one", lambda: reds(display, (640, 480)) > 1.5 * small
            )
            act("mousemove 100 100 key Escape")
            assert viewer.wait(WAIT_S) == 0
            assert viewer.stderr is not None
            assert viewer.stderr.read() == ""
        finally:
            viewer.kill()


def test_what_is_no_model_is_told_in_the_window(
    display: str, tmp_path: Path
) -> None:
    """The window stays: somebody can open another file."""
    path = tmp_path / "broken.glb"
    path.write_bytes(b"nothing")
    with subprocess.Popen(
        [
            *(sys.executable, "-m", "moka", "view", str(path)),
            *("--size", "400x300", "--no-preferences"),
        ],
        env={**os.environ, "DISPLAY": display},
    ) as viewer:
        try:
            wait_for("a window", lambda: act("search --name moka"))
            time.sleep(1.0)
            assert viewer.poll() is None
            wait_for(
                "the end",
                lambda: (
                    act("mousemove 100 100 key Escape")
                    or viewer.poll() is not None
                ),
            )
            assert viewer.returncode == 0
        finally:
            viewer.kill()
