"""The command line as a process: Ctrl-C, and readers that go away."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import NoReturn

__all__ = ["INTERRUPTED", "run_process"]

INTERRUPTED = 130

# What unwinding after Ctrl-C may take. It removes files that are half
# written; the rest of it may wait for a driver, which can draw for minutes.
_PATIENCE = 0.5


def run_process(command: Callable[[], int]) -> NoReturn:
    """Run ``command`` as all that this process does, and end with its code.

    After Ctrl-C the process ends within a second, whatever its threads are
    doing. A reader who closes our output early is not an error.
    """
    # Where someone ignores the signal, as nohup does, it stays ignored.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    try:
        code = command()
    finally:
        _flush_output()
    _end(code)


def _flush_output() -> None:
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        # Python would try again at its end, and complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _interrupt(_number: int, _frame: FrameType | None) -> NoReturn:
    watchdog = threading.Timer(_PATIENCE, _give_up)
    watchdog.daemon = True
    watchdog.start()
    raise KeyboardInterrupt


def _give_up() -> NoReturn:
    print("moka: error: interrupted", file=sys.stderr)
    _end(INTERRUPTED)


def _end(code: int) -> NoReturn:
    """End at once.

    The interpreter itself would wait for threads, and then take down object
    by object what the system takes back as a whole: 30 ms after a picture.
    """
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)
