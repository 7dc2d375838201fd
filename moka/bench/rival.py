"""Another program that draws a frame whenever it is asked to.

It reads lines from its standard input and, for each, draws the next frame,
waits until it is finished and prints its wall time and its CPU time in
milliseconds. What it prints before its first answer is passed over.
"""

import subprocess
from collections.abc import Sequence
from types import TracebackType

from moka.core.errors import MokaError

__all__ = ["Rival"]


class Rival:
    """The program; use it in a ``with`` block, which ends it.

    Raises MokaError if it cannot be started.
    """

    def __init__(self, command: Sequence[str]) -> None:
        self._name = command[0]
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        except OSError as error:
            raise MokaError(
                f"{command[0]}: cannot be run: {error.strerror}"
            ) from error

    def __enter__(self) -> "Rival":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.kill()
        self._process.communicate()

    def draw(self) -> tuple[float, float]:
        """Wall and CPU time of its next frame, in milliseconds.

        Raises MokaError if it ends instead.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write("\n")
            self._process.stdin.flush()
        except OSError:
            pass  # It has ended, as the next line tells.
        for line in self._process.stdout:
            try:
                wall, cpu = map(float, line.split())
            except ValueError:
                continue
            return wall, cpu
        raise MokaError(
            f"{self._name}: ended with exit code {self._process.wait()} "
            "instead of drawing a frame"
        )
