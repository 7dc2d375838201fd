"""Reads the GPU's clock between commands, and never waits for it."""

from collections import deque

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.commands.commands import Timestamp, Timestamps

__all__ = ["TimestampQueries"]

# Frames whose times have not arrived. A driver that never tells must not
# make this grow.
_MOST_PENDING = 16


class TimestampQueries:
    """The queries of the frames in flight, reused when their times are in."""

    def __init__(self, gl: Functions) -> None:
        self._gl = gl
        self._free: list[int] = []
        self._pending: deque[tuple[Timestamps, list[tuple[str, int]]]] = deque()

    def record(self, command: Timestamp) -> None:
        """Have the clock read when the GPU gets here."""
        query = self._free.pop() if self._free else self._gl.make("Queries")
        self._gl.QueryCounter(query, c.TIMESTAMP)
        mark = command.label, query
        for into, marks in self._pending:
            if into is command.into:
                marks.append(mark)
                return
        self._pending.append((command.into, [mark]))

    def collect(self) -> None:
        """Hand over the times that have arrived, oldest first."""
        gl = self._gl
        while self._pending:
            into, marks = self._pending[0]
            # The GPU reaches them in order.
            if gl.is_available(marks[-1][1]):
                into.marks = [
                    (label, gl.query_result(query)) for label, query in marks
                ]
            elif len(self._pending) <= _MOST_PENDING:
                return
            self._pending.popleft()
            self._free += [query for _, query in marks]

    def release(self) -> None:
        """Delete all queries."""
        for _, marks in self._pending:
            self._free += [query for _, query in marks]
        self._pending.clear()
        for query in self._free:
            self._gl.delete("Queries", query)
        self._free.clear()
