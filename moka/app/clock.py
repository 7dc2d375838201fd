"""When updates happen: as time passes, or in steps of one length."""

from collections.abc import Iterator

from moka.app.application import GameTime

__all__ = ["LONGEST_DELTA", "Clock"]

# A frame after a stall (a breakpoint, a window being dragged) must not make
# things jump.
LONGEST_DELTA = 0.25


class Clock:
    """Game time: it stalls where the program does, and stops in a pause.

    Without a fixed step there is one update for each frame, as long as the
    frame. With one, updates of that length follow as fast as time has
    passed; what is left over counts for the next frame (Fiedler 2004, "Fix
    Your Timestep!").
    """

    def __init__(self) -> None:
        self._total = 0.0
        self._updates = 0
        self._frames = 0
        self._owed = 0.0

    def advance(
        self,
        elapsed: float,
        *,
        fixed_step: float | None = None,
        paused: bool = False,
    ) -> Iterator[GameTime]:
        """The updates of a frame, ``elapsed`` seconds after the one before.

        The first frame has one update of no length, or of one step. The
        clock moves on with the iterator.
        """
        if paused:
            self._owed = 0.0
            return
        if fixed_step is None:
            yield self._step(min(elapsed, LONGEST_DELTA))
            return
        self._owed += min(elapsed, max(LONGEST_DELTA, fixed_step))
        if not self._updates:
            self._owed = max(self._owed, fixed_step)
        # A step more than is owed by a rounding error is owed.
        while self._owed >= fixed_step * (1 - 1e-9):
            self._owed -= fixed_step
            yield self._step(fixed_step)

    def frame(self, elapsed: float, *, paused: bool = False) -> GameTime:
        """When a frame is drawn, after its updates."""
        delta = 0.0 if paused else min(elapsed, LONGEST_DELTA)
        time = GameTime(delta, self._total, self._frames)
        self._frames += 1
        return time

    def _step(self, delta: float) -> GameTime:
        self._total += delta
        time = GameTime(delta, self._total, self._updates)
        self._updates += 1
        return time
