"""Writes a sequence of pictures: numbered files, moving pictures, or both."""

import queue
import re
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from moka.core.image import Image
from moka.core.moving_picture import MOVING_SUFFIXES, write_moving_picture

__all__ = ["FrameFiles", "frame_path", "is_moving", "numbers_written"]

# Frames that wait to be encoded; more would only take memory.
_WAITING = 2

# How long, in seconds, a full queue waits before it asks why.
_PATIENCE = 0.1


def is_moving(path: Path) -> bool:
    """Whether one file of this kind holds many pictures."""
    return path.suffix.lower() in MOVING_SUFFIXES


def frame_path(path: Path, number: int) -> Path:
    """The file of frame ``number``: out.png becomes out.0007.png.

    The last run of ``#`` in the name stands for the number instead, padded
    to its length.
    """
    places = list(re.finditer("#+", path.name))
    if not places:
        return path.with_name(f"{path.stem}.{number:04}{path.suffix}")
    start, end = places[-1].span()
    digits = f"{number:0{end - start}}"
    return path.with_name(path.name[:start] + digits + path.name[end:])


def numbers_written(paths: Iterable[Path], count: int) -> frozenset[int]:
    """Which of ``count`` frames all ``paths`` have files of already."""
    numbered = list(paths)
    return frozenset(
        number
        for number in range(count)
        if all(frame_path(path, number).is_file() for path in numbered)
    )


class FrameFiles:
    """Writes frames as they come, while the next ones are drawn.

    In a ``with`` block: numbered files are there, whole, as soon as they are
    written; a moving picture is there at the end of the block, and not at
    all if the block raises. Raises ImageFileError where a file cannot be
    written, at the next call.
    """

    def __init__(
        self, paths: Iterable[Path], frames_per_second: float, *, half: bool
    ) -> None:
        outputs = list(paths)
        self._numbered = [path for path in outputs if not is_moving(path)]
        self._half = half
        self._pool = ThreadPoolExecutor(
            1 + len(outputs), thread_name_prefix="moka-write"
        )
        self._saving: Future[None] | None = None
        self._feeds = [
            _Feed(self._pool, path, frames_per_second)
            for path in outputs
            if is_moving(path)
        ]

    def __enter__(self) -> "FrameFiles":
        return self

    def __exit__(
        self, _: object, error: BaseException | None, __: object
    ) -> None:
        with ExitStack() as stack:
            stack.enter_context(self._pool)
            for feed in self._feeds:
                stack.callback(feed.end, error)
            if error is None:
                self._wait()

    def write(self, number: int, image: Image) -> None:
        """Take frame ``number``; returns when it waits to be written."""
        self._wait()
        if self._numbered:
            paths = [frame_path(path, number) for path in self._numbered]
            self._saving = self._pool.submit(
                image.save_all, paths, half=self._half
            )
        for feed in self._feeds:
            feed.put(image.to_display())

    def _wait(self) -> None:
        saving, self._saving = self._saving, None
        if saving is not None:
            saving.result()


class _Feed:
    """The frames of one moving picture, on their way to its writer."""

    def __init__(
        self, pool: ThreadPoolExecutor, path: Path, frames_per_second: float
    ) -> None:
        self._frames: queue.Queue[NDArray[np.uint8] | BaseException | None] = (
            queue.Queue(_WAITING)
        )
        self._writing = pool.submit(
            write_moving_picture, path, self._arriving(), frames_per_second
        )

    def put(self, frame: "NDArray[np.uint8] | BaseException | None") -> None:
        """Hand a frame over, None for the end, or why there will be none."""
        while not self._writing.done():
            try:
                self._frames.put(frame, timeout=_PATIENCE)
            except queue.Full:
                continue
            return
        self._writing.result()

    def end(self, error: BaseException | None) -> None:
        """Finish the file, or without it where an ``error`` came."""
        if error is None:
            self.put(None)
            self._writing.result()
        elif not self._writing.done():
            self.put(error)
            self._writing.exception()

    def _arriving(self) -> Iterator[NDArray[np.uint8]]:
        while True:
            frame = self._frames.get()
            if frame is None:
                return
            if isinstance(frame, BaseException):
                raise frame
            yield frame
