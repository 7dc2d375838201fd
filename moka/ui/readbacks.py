"""What the viewer reads back from the GPU: pictures and what was clicked."""

from collections import deque
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.core.image import Image
from moka.ui.picking import begin_pick, finish_pick

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["Readbacks"]


class Readbacks:
    """Records what is wanted into a frame, and acts when it has arrived."""

    def __init__(self, viewer: "Viewer") -> None:
        self._viewer = viewer
        self._reads: list[tuple[list[Readback], Callable[[], None]]] = []
        self._asked: deque[Path] = deque()
        self._saves: Path | None = None
        self._wants_pick: tuple[tuple[float, float], bool] | None = None

    @property
    def are_pending(self) -> bool:
        """Whether anything has not arrived, or waits for another frame."""
        return bool(self._reads or self._asked)

    @property
    def saves_picture(self) -> bool:
        """Whether this frame's picture is to be saved, if it is whole."""
        return self._saves is not None

    def save_picture(self, path: Path) -> None:
        """Save the next whole picture. May be called on any thread."""
        self._asked.append(path)

    def begin_frame(self) -> None:
        """Decide what this frame saves; what is asked later waits."""
        if self._saves is None and self._asked:
            self._saves = self._asked.popleft()

    def pick(self, place: tuple[float, float], *, is_double: bool) -> None:
        """Select what is at a place of the window; twice, go around it."""
        self._wants_pick = place, is_double

    def record(self, commands: CommandList) -> None:
        """Read what is wanted of the picture that ``commands`` draw."""
        viewer = self._viewer
        self._read_picture(commands)
        self._pick(commands, viewer.window_size)

    def _read_picture(self, commands: CommandList) -> None:
        viewer = self._viewer
        path = self._saves
        if path is None:
            return
        is_whole = viewer.renderer.is_complete and not viewer.draft.is_now
        if viewer.debug_view is not None or not is_whole:
            # A picture is one of light, and of all of it.
            return
        self._saves = None
        read = viewer.renderer.read_radiance(commands)
        settings = viewer.settings

        def save() -> None:
            assert read.data is not None
            image = Image(
                np.ascontiguousarray(read.data[::-1]),
                tone_map=settings.tone_map,
                exposure=settings.exposure,
                gamma=settings.gamma,
            )
            viewer.work.start(
                f"writing {path}",
                partial(image.save, path),
                lambda _: viewer.tell(f"saved {path}"),
            )

        self.when_read([read], save)

    def _pick(self, commands: CommandList, window: tuple[int, int]) -> None:
        """Find out what was clicked; twice, and go around it from now on."""
        viewer = self._viewer
        wanted, self._wants_pick = self._wants_pick, None
        if wanted is None or viewer.model is None:
            return
        (x, y), is_double = wanted
        size = viewer.renderer.size
        pixel = (
            int(x / (window[0] - viewer.column_width) * size[0]),
            int(y / window[1] * size[1]),
        )
        if not (0 <= pixel[0] < size[0] and 0 <= pixel[1] < size[1]):
            return
        read = begin_pick(
            viewer.renderer, viewer.scene, viewer.camera, pixel, commands
        )

        def then() -> None:
            picked = finish_pick(read, viewer.camera, pixel, size)
            if picked is None or viewer.model is None:
                viewer.selection = None
                return
            nodes = viewer.model.model.nodes
            viewer.selection = nodes.row_of_number(picked.number - 1)
            if is_double:
                viewer.controls.set_pivot(picked.point.tolist())
                viewer.viewpoint.follow()

        self.when_read(list(read.values()), then)

    def when_read(
        self, reads: list[Readback], then: Callable[[], None]
    ) -> None:
        """Do ``then`` when all of ``reads`` have arrived."""
        self._reads.append((reads, then))
        self._viewer.request_redraw()

    def take(self) -> None:
        """Act on what has arrived."""
        waiting = self._reads
        self._reads = []
        for reads, then in waiting:
            if all(read.data is not None for read in reads):
                then()
            else:
                self._reads.append((reads, then))
