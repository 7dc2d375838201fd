"""A line on a terminal that says how far a long run has come."""

import shutil
import sys
import time
from typing import TextIO

__all__ = ["Progress"]

# More often than this nobody can read it.
_PERIOD = 0.1


class Progress:
    """Shows ``done`` of ``total`` steps; silent where no terminal is.

    It is silent also if ``is_shown`` is false. Leave its ``with`` block to
    take the line away again.
    """

    def __init__(
        self,
        what: str,
        total: int,
        stream: TextIO | None = None,
        *,
        is_shown: bool = True,
    ) -> None:
        self._what = what
        self.total = total
        self._stream = stream or sys.stderr
        self._is_shown = is_shown and self._stream.isatty()
        self._started = time.monotonic()
        self._next = 0.0
        self.done = 0

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *exception: object) -> None:
        if self._is_shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def step(self, count: int = 1) -> None:
        """``count`` more steps are done."""
        self.done += count
        now = time.monotonic()
        if not self._is_shown or now < self._next:
            return
        self._next = now + _PERIOD
        width = shutil.get_terminal_size().columns - 1
        self._stream.write("\r\x1b[K" + self._line(now)[:width])
        self._stream.flush()

    def _line(self, now: float) -> str:
        rate = self.done / max(now - self._started, 1e-9)
        left = round((self.total - self.done) / max(rate, 1e-9))
        return (
            f"{self._what} {self.done}/{self.total}  {rate:.1f} per second  "
            f"{left // 60}:{left % 60:02} left"
        )
