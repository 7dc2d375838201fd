"""Times and counters of one run: what was done and what was skipped.

The names are those of the statistics file that ``moka render --stats``
writes. Stages may overlap, since decoding runs in worker threads while the
render thread compiles, so that their sum can exceed the total.
"""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["Statistics"]


class Statistics:
    """Collects stage times in milliseconds and counters, from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._started = time.perf_counter()
        self.stages_ms: dict[str, float] = {}
        self.counts: dict[str, int] = {}
        self.lighting: dict[str, Any] = {}
        self.gl: dict[str, Any] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time spent in the block to stage ``name``."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.add_time(name, time.perf_counter() - start)

    def add_time(self, name: str, seconds: float) -> None:
        """Add ``seconds`` to stage ``name``."""
        with self._lock:
            before = self.stages_ms.get(name, 0.0)
            self.stages_ms[name] = before + 1000.0 * seconds

    def count(self, name: str, amount: int = 1) -> None:
        """Add ``amount`` to counter ``name``."""
        with self._lock:
            self.counts[name] = self.counts.get(name, 0) + amount

    def set_count(self, name: str, value: int) -> None:
        """Set counter ``name``, for figures that describe one frame."""
        with self._lock:
            self.counts[name] = value

    @property
    def total_ms(self) -> float:
        """Milliseconds since this object was made."""
        return 1000.0 * (time.perf_counter() - self._started)
