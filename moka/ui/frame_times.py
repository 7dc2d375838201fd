"""Where the time of the last frames went, on the CPU and on the GPU."""

import time
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.commands import Timestamps
from moka.commands.sort_key import SortKey
from moka.renderer.frame_order import (
    PASS_ACCUMULATE,
    PASS_DEBUG,
    PASS_DISPLAY,
    PASS_READ,
    PASS_SCENE,
    PASS_VALUES,
)

__all__ = [
    "FRAMES",
    "PASS_INTERFACE",
    "FrameTimes",
    "History",
    "mark_passes",
]

#: Behind every pass of the renderer.
PASS_INTERFACE = PASS_READ + 1

#: How many frames are remembered.
FRAMES = 240

_PASSES = {
    "before": 0,
    "scene": PASS_SCENE,
    "accumulation": PASS_ACCUMULATE,
    "display": PASS_DISPLAY,
    "values": PASS_VALUES,
    "debug view": PASS_DEBUG,
    "reading": PASS_READ,
    "panels": PASS_INTERFACE,
}
# The last pass that a sort key can name, behind the panels.
_LAST_PASS = 15

# The GPU's times of so many frames are waited for.
_MOST_PENDING = 8


def mark_passes(
    commands: CommandList, times: Timestamps, prefix: str = ""
) -> None:
    """Have the GPU's clock read between the renderer's passes.

    To be called before anything else is recorded into ``commands``: entries
    of one key stay in the order of their recording.
    """
    for label, number in _PASSES.items():
        commands.timestamp(prefix + label, times, key=SortKey(number))
    commands.timestamp("end", times, key=SortKey(_LAST_PASS))


class History:
    """The last values of some series, by name, oldest first.

    A series that has no value in a frame has 0 there.
    """

    def __init__(self) -> None:
        self.series: dict[str, NDArray[np.float64]] = {}

    def put(self, values: Mapping[str, float]) -> None:
        """Add a frame."""
        for name in values.keys() - self.series.keys():
            self.series[name] = np.zeros(FRAMES)
        for name, series in list(self.series.items()):
            series[:-1] = series[1:]
            series[-1] = values.get(name, 0.0)
            if not series.any():
                del self.series[name]

    @property
    def total(self) -> NDArray[np.float64]:
        """The sum of all series, (FRAMES,)."""
        total = np.zeros(FRAMES)
        for series in self.series.values():
            total += series
        return total

    def mean(self, name: str, frames: int = 30) -> float:
        """The mean of a series' last values."""
        return float(self.series[name][-frames:].mean())


class FrameTimes:
    """Milliseconds of the stages of frames on the ``cpu``, passes on ``gpu``.

    The GPU's clock is read only in frames before which ``wants_gpu`` was
    set: whoever shows the times sets it again in every frame.
    """

    def __init__(self) -> None:
        self.cpu = History()
        self.gpu = History()
        self.wants_gpu = False
        self._now: dict[str, float] = {}
        self._pending: deque[list[Timestamps]] = deque()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time of the block to a stage of this frame."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.add(name, time.perf_counter() - start)

    def add(self, name: str, seconds: float) -> None:
        """Add ``seconds`` to a stage of this frame."""
        self._now[name] = self._now.get(name, 0.0) + 1000.0 * seconds

    def begin_frame(self) -> list[Timestamps]:
        """End the frame before; where the GPU's times of this one arrive.

        One place for each command list, none if nobody wants to know.
        """
        if self._now:
            self.cpu.put(self._now)
            self._now = {}
        self._collect()
        if not self.wants_gpu:
            return []
        self.wants_gpu = False
        places = [Timestamps(), Timestamps()]
        self._pending.append(places)
        while len(self._pending) > _MOST_PENDING:
            self._pending.popleft()
        return places

    def _collect(self) -> None:
        while self._pending:
            # The first is of the list that is always submitted, and last.
            first, *others = self._pending[0]
            spent = first.seconds
            if spent is None:
                return
            self._pending.popleft()
            for other in others:
                spent |= other.seconds or {}
            self.gpu.put({name: 1000.0 * each for name, each in spent.items()})
