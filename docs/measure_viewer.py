"""Measures `moka view` in a window, and takes the picture of docs/viewer.md.

    python docs/measure_viewer.py MODEL [ENVIRONMENT] [--picture PATH]

Needs an X display with xdotool, or Xvfb to make one. Prints how long the
first picture takes, what an idle window costs, how late a frame is after an
event, and how many frames a second an orbit has.
"""

import argparse
import contextlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from statistics import median
from typing import Any

import numpy as np
from PIL import ImageGrab

import moka
from moka.app.events import Event, MouseMoveEvent
from moka.app.render_request import RenderRequest
from moka.ui.viewer import Viewer

SIZE = (1280, 720)
# The panels of the picture.
OPEN = ("Picture", "Compare", "Profiler")
PATIENCE_S = 40.0


@contextlib.contextmanager
def a_display() -> Iterator[str]:
    """The display that there is, else an Xvfb."""
    if os.environ.get("DISPLAY"):
        yield os.environ["DISPLAY"]
        return
    read, write = os.pipe()
    command = [
        "Xvfb",
        "-displayfd",
        str(write),
        "-screen",
        "0",
        "1280x720x24",
        "-noreset",
    ]
    with subprocess.Popen(
        command, pass_fds=[write], stderr=subprocess.DEVNULL
    ) as server:
        os.close(write)
        with os.fdopen(read) as number:
            os.environ["DISPLAY"] = f":{number.readline().strip()}"
        try:
            yield os.environ["DISPLAY"]
        finally:
            server.terminate()


def seen() -> np.ndarray[Any, Any]:
    """What the middle of the picture shows; a little, which costs little."""
    return np.asarray(ImageGrab.grab((440, 300, 540, 400)).convert("RGB"))


def measure_start(arguments: list[str]) -> None:
    """Of a process: the window, its complete picture, and its idleness."""
    command = [sys.executable, "-m", "moka", "view", *arguments]
    command += ["--no-preferences", "--size", f"{SIZE[0]}x{SIZE[1]}"]
    start = time.perf_counter()
    with subprocess.Popen(command) as process:
        before, window, changed = seen(), None, start
        while time.perf_counter() - changed < 3.0 or window is None:
            now = seen()
            if (now != before).any():
                changed = time.perf_counter()
                window = window or changed
            before = now
            time.sleep(0.02)
            assert time.perf_counter() - start < PATIENCE_S
        print(f"window after {window - start:.2f} s")
        print(f"complete picture after {changed - start:.2f} s")
        spent = cpu_seconds(process.pid)
        time.sleep(10.0)
        spent = cpu_seconds(process.pid) - spent
        print(f"idle: {spent / 10.0:.2%} of a core")
        process.terminate()


def cpu_seconds(process: int) -> float:
    """What a process and its threads have used, on Linux."""
    with open(f"/proc/{process}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    ticks = int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


class Watched(Viewer):
    """Notes when events came, and how long the window did not answer."""

    def __init__(self, request: RenderRequest) -> None:
        super().__init__(request)
        self.moved = 0.0
        self.drawn = 0
        self.longest = 0.0
        self._answered = time.perf_counter()

    def event(self, event: Event) -> None:
        """Note the time of a motion."""
        if isinstance(event, MouseMoveEvent):
            self.moved = time.perf_counter()
        super().event(event)

    def draw(self, *given: Any) -> None:
        """Count, and note how long this took."""
        start = time.perf_counter()
        super().draw(*given)
        self.drawn += 1
        self.longest = max(self.longest, time.perf_counter() - start)


def wait_for(condition: Callable[[], bool]) -> None:
    """Return when it holds; looks every millisecond."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.001)


def measure_frames(viewer: Watched, picture: str | None) -> None:
    """The story of somebody who looks at a clock."""
    wait_for(lambda: viewer.model is not None and not viewer.work.doing)
    time.sleep(3.0)
    print(f"longest wait of the window {1000 * viewer.longest:.0f} ms")
    if picture:
        take_picture(viewer, picture)
    act("mousemove", "400", "400")
    act("mousedown", "1")
    late = []
    for number in range(30):
        time.sleep(0.03)
        frame = viewer.frame
        act("mousemove", str(401 + 3 * number), "400")
        wait_for(lambda frame=frame: viewer.frame is not frame)  # type: ignore[misc]
        assert viewer.frame is not None
        viewer.frame.wait_for_execution()
        viewer.device.finish()
        late.append(time.perf_counter() - viewer.moved)
    act("mouseup", "1")
    print(f"a frame {1000 * median(late):.0f} ms after its event")
    viewer.auto_rotates = True
    viewer.request_redraw()
    time.sleep(1.0)
    start, first = time.perf_counter(), viewer.drawn
    time.sleep(5.0)
    rate = (viewer.drawn - first) / (time.perf_counter() - start)
    print(f"{rate:.1f} frames a second in an orbit")
    viewer.quit()
    viewer.request_redraw()


def take_picture(viewer: Watched, path: str) -> None:
    """The window as docs/viewer.md shows it."""
    viewer.comparison.choice = "BRDF blinn-phong"
    viewer.comparison.divider = 0.55
    viewer.measure_error()
    wait_for(lambda: viewer.measurement is None or viewer.measurement.is_done)
    viewer.controls.orbit(0.0, 0.0)
    for _ in range(60):
        viewer.request_redraw()
        time.sleep(0.1)
    ImageGrab.grab((0, 0, *SIZE)).save(path)
    viewer.comparison.choice = None
    viewer.request_redraw()


def act(*words: str) -> None:
    """Do what xdotool understands."""
    subprocess.run(["xdotool", *words], check=True)


def main() -> None:
    """Measure it all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", nargs="?")
    parser.add_argument("environment", nargs="?", default="studio")
    parser.add_argument("--picture")
    given = parser.parse_args()
    with a_display():
        model = [given.model] if given.model else []
        measure_start([*model, "--environment", given.environment])
        viewer = Watched(
            RenderRequest(source=given.model, environment=given.environment)
        )
        for panel in viewer.panels:
            panel.starts_open = panel.title in OPEN if given.picture else False
        person = threading.Thread(
            target=measure_frames, args=(viewer, given.picture)
        )
        person.start()
        moka.run(viewer, size=SIZE, vsync=False)
        person.join()


if __name__ == "__main__":
    main()
