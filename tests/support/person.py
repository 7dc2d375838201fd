"""Somebody at the mouse and the keyboard, while an app runs."""

import shutil
import subprocess
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import ImageGrab

from moka.app.application import App

__all__ = ["Person"]

PATIENCE_S = 60.0


class Person:
    """Acts through xdotool on a thread of its own, then closes the app.

    ``story`` is what it does. What it finds wrong is raised by :meth:`leave`
    on the thread of the test.
    """

    def __init__(
        self, app: App, display: str, story: Callable[["Person"], None]
    ) -> None:
        if shutil.which("xdotool") is None:
            pytest.skip("there is no xdotool")
        self._app = app
        self._display = display
        self._story = story
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._live)

    def come(self) -> None:
        """Begin; to be called before the app runs."""
        self._thread.start()

    def leave(self) -> None:
        """Wait for the end of the story; raises what went wrong in it."""
        self._thread.join(PATIENCE_S)
        if self._error is not None:
            raise self._error

    def act(self, commands: str) -> None:
        """Do what xdotool understands."""
        subprocess.run(["xdotool", *commands.split()], check=True, timeout=30)

    def wait(self, what: str, condition: Callable[[], bool]) -> None:
        """Wait until ``condition`` holds, a minute at most."""
        deadline = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < deadline, f"{what}: did not happen"
            time.sleep(0.02)

    def look(self, box: tuple[int, int, int, int]) -> NDArray[np.uint8]:
        """What a part of the screen shows, (height, width, 3)."""
        image = ImageGrab.grab(bbox=box, xdisplay=self._display)
        return np.asarray(image.convert("RGB"))

    def _live(self) -> None:
        try:
            self._story(self)
        except BaseException as error:
            self._error = error
        finally:
            self._app.quit()
            self._app.request_redraw()
