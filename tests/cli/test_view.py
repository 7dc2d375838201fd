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

from moka.core.radiance_hdr import write_radiance_hdr
from moka.material.material import Material
from moka.model import cube, model_of, save_model
from tests.support.display import running_display
from tests.support.file_drag import drop_files

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


RED, _, BLUE = range(3)


def count(display: str, size: tuple[int, int], channel: int) -> int:
    """How many pixels of the screen's upper left are of one colour."""
    image = ImageGrab.grab(bbox=(0, 0, *size), xdisplay=display)
    pixels = np.asarray(image.convert("RGB"), int)
    others = np.delete(pixels, channel, axis=2).max(axis=2)
    one = pixels[..., channel]
    return int(((one > 150) & (one > others + 60)).sum())


def save_cube(path: Path, colour: tuple[float, float, float, float]) -> None:
    material = Material(base_colour_factor=colour, metallic_factor=0.0)
    save_model(model_of([(cube(1.0), material, np.eye(4))]), path)


def test_it_opens_resizes_and_ends_well(display: str, tmp_path: Path) -> None:
    path = tmp_path / "cube.glb"
    save_cube(path, (1, 0.1, 0.05, 1))
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
            small = (400, 300)
            wait_for("a picture", lambda: count(display, small, RED) > 100)
            before = count(display, small, RED)
            act("search --name moka windowsize 640 480")
            wait_for(
                "a larger one",
                lambda: count(display, (640, 480), RED) > 1.5 * before,
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


def test_what_is_dropped_into_the_window_is_opened(
    display: str, tmp_path: Path
) -> None:
    grey, red = tmp_path / "grey.glb", tmp_path / "a red cube.glb"
    save_cube(grey, (0.5, 0.5, 0.5, 1))
    save_cube(red, (1, 0.1, 0.05, 1))
    blue = tmp_path / "blauer Würfel.hdr"
    write_radiance_hdr(blue, np.full((8, 16, 3), (0.02, 0.05, 1.0)))
    size = (400, 300)
    with subprocess.Popen(
        [
            *(sys.executable, "-m", "moka", "view", str(grey)),
            *("--environment", "furnace", "--size", "400x300"),
            *("--no-cache", "--no-preferences"),
        ],
        env={**os.environ, "DISPLAY": display},
        stderr=subprocess.PIPE,
        text=True,
    ) as viewer:
        try:
            wait_for("the model", lambda: act("search --name ^grey"))
            assert count(display, size, RED) == 0
            drop_files(display, [red], at=(100, 150))
            wait_for("a red one", lambda: count(display, size, RED) > 100)
            assert act("search --name ^a.red.cube")
            # The marks of the panels, and no more.
            assert count(display, size, BLUE) < 1_000
            drop_files(display, [blue], at=(100, 150))
            wait_for("a blue sky", lambda: count(display, size, BLUE) > 10_000)
            act("mousemove 100 100 key Escape")
            assert viewer.wait(WAIT_S) == 0
            assert viewer.stderr is not None
            assert viewer.stderr.read() == ""
        finally:
            viewer.kill()
