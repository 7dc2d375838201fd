"""Fewer samples while things move, where all of them would be too slow."""

import time
from collections import deque

from msgspec.structs import replace

from moka.renderer.settings import RenderSettings

__all__ = ["Draft"]

# A frame that takes longer is felt behind the hand.
_SLOW = 1 / 20

# After so many seconds without motion the picture is made as it should be.
_REST = 0.15


class Draft:
    """Decides for each frame whether it is a draft.

    While something moves, edges have one sample a pixel if a frame with all
    of them takes longer than a twentieth of a second. ``is_wanted`` turns
    that off. Nothing is compiled for it, and a still picture has no part in
    it.
    """

    def __init__(self) -> None:
        self.is_wanted = True
        self.is_now = False
        self._moved = 0.0
        self._slow = False
        # Whether the last frames were drafts; one is in flight, one waits.
        self._drafts = deque([False] * 3, maxlen=3)

    def note_motion(self) -> None:
        """Something moves now."""
        self._moved = time.monotonic()

    def note_wait(self, seconds: float) -> None:
        """How long the loop has waited for a frame; 0 after a rest."""
        if seconds > 0.0 and not any(self._drafts):
            self._slow = seconds > _SLOW

    @property
    def is_moving(self) -> bool:
        """Whether something moved a moment ago."""
        return time.monotonic() - self._moved < _REST

    def settings(self, wanted: RenderSettings) -> RenderSettings:
        """What to draw this frame with; samples of light are kept as is."""
        self.is_now = (
            self.is_wanted
            and self.is_moving
            and self._slow
            and wanted.samples > 1
            and wanted.ibl != "reference"
        )
        self._drafts.append(self.is_now)
        return replace(wanted, samples=1) if self.is_now else wanted
