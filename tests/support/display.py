"""A display for tests that open windows."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

__all__ = ["running_display"]


@contextmanager
def running_display() -> Iterator[str]:
    """The display of this session, else an Xvfb on a free number.

    Skips the test where there is neither.
    """
    if os.environ.get("DISPLAY"):
        yield os.environ["DISPLAY"]
        return
    if shutil.which("Xvfb") is None:
        pytest.skip("there is no display and no Xvfb")
    read, write = os.pipe()
    command = [
        *("Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24"),
        # Else it begins anew where the last window goes as the next comes.
        "-noreset",
    ]
    with subprocess.Popen(
        command, pass_fds=[write], stderr=subprocess.DEVNULL
    ) as server:
        os.close(write)
        with os.fdopen(read) as number:
            display = f":{number.readline().strip()}"
        try:
            os.environ["DISPLAY"] = display
            yield display
        finally:
            del os.environ["DISPLAY"]
            server.terminate()
