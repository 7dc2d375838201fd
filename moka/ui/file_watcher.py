"""Tells when files change, through watchfiles."""

import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from watchfiles import BaseFilter

__all__ = ["FileWatcher"]


class FileWatcher:
    """Watches files, and folders with all that is in them.

    ``changed`` is called with what has changed, on a thread of its own: what
    an editor writes in several steps is one change. Without the package
    watchfiles nothing is ever told.
    """

    def __init__(self, changed: Callable[[frozenset[Path]], None]) -> None:
        self._changed = changed
        self._stop = threading.Event()
        self._threads: list[threading.Thread] = []
        self._watched: frozenset[Path] = frozenset()

    def watch(self, paths: Iterable[Path]) -> None:
        """Watch ``paths`` from now on, and nothing else."""
        wanted = frozenset(path.resolve() for path in paths)
        if wanted == self._watched:
            return
        # The thread before ends when it looks next; nobody waits for it.
        self._stop.set()
        self._threads = [each for each in self._threads if each.is_alive()]
        self._watched = wanted
        if not wanted:
            return
        self._stop = threading.Event()
        thread = threading.Thread(
            target=self._run,
            args=(wanted, self._stop),
            name="moka-watch",
            daemon=True,
        )
        self._threads.append(thread)
        thread.start()

    def close(self) -> None:
        """Watch nothing any more; waits for its threads."""
        self._watched = frozenset()
        self._stop.set()
        for thread in self._threads:
            thread.join()
        self._threads.clear()

    def _run(self, wanted: frozenset[Path], stop: threading.Event) -> None:
        try:
            from watchfiles import watch
        except ImportError:
            return
        # Editors replace a file by another, which only its folder knows of;
        # below that folder may be all that a person has.
        folders = {path.parent for path in wanted if path.parent.is_dir()}
        for path in wanted:
            if path.is_dir():
                below = (each for each in path.rglob("*") if each.is_dir())
                folders |= {path, *below}
        changes = watch(
            *folders,
            watch_filter=_within(wanted),
            stop_event=stop,
            rust_timeout=200,
            debounce=200,
            recursive=False,
            raise_interrupt=False,
        )
        for found in changes:
            if stop.is_set():
                return
            self._changed(frozenset(Path(path) for _, path in found))


def _within(wanted: frozenset[Path]) -> "BaseFilter | Callable[..., bool]":
    def is_wanted(_: object, path: str) -> bool:
        changed = Path(path)
        return any(
            changed == watched or watched in changed.parents
            for watched in wanted
        )

    return is_wanted
