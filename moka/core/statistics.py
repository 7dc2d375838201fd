"""Times and counters of one run: what was done and what was skipped.

The names are those of the statistics file that ``moka render --stats``
writes. Stages may overlap, since decoding runs in worker threads while the
render thread compiles, so that their sum can exceed the total.
"""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from moka.core.errors import MokaError
from moka.version import __version__

__all__ = ["Statistics", "write_statistics"]


class Statistics:
    """Collects stage times in milliseconds and counters, from any thread.

    The total counts from ``started``, a time of ``time.perf_counter``.
    """

    def __init__(self, started: float | None = None) -> None:
        self._lock = threading.Lock()
        self._started = time.perf_counter() if started is None else started
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
        """Milliseconds since the start."""
        return 1000.0 * (time.perf_counter() - self._started)

    def as_dict(self) -> dict[str, Any]:
        """The content of the statistics file; see docs."""
        with self._lock:
            return {
                "moka": __version__,
                "gl": dict(self.gl),
                "stages_ms": {
                    name: round(value, 3)
                    for name, value in self.stages_ms.items()
                },
                "total_ms": round(self.total_ms, 3),
                "peak_rss_mb": _peak_memory_mb(),
                "counts": dict(self.counts),
                "lighting": dict(self.lighting),
            }


def write_statistics(statistics: Statistics, path: Path) -> None:
    """Write the statistics as JSON; raises MokaError if it cannot."""
    import json

    text = json.dumps(statistics.as_dict(), indent=2) + "\n"
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise MokaError(f"{path}: cannot write: {error.strerror}") from error


def _peak_memory_mb() -> float | None:
    """The largest resident set of this process, where the system tells."""
    try:
        # Linux hands getrusage's figure down from the parent of a process.
        status = Path("/proc/self/status").read_text(encoding="ascii")
        line = next(
            line for line in status.splitlines() if line.startswith("VmHWM:")
        )
        return round(int(line.split()[1]) / 1024, 1)
    except (OSError, StopIteration):
        pass
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # Bytes on macOS, kibibytes elsewhere.
    return round(peak / (1 << (20 if sys.platform == "darwin" else 10)), 1)
