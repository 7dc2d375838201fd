"""Files that change, and those that are not watched."""

import os
import queue
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from moka.ui.file_watcher import FileWatcher

watchfiles = pytest.importorskip("watchfiles")

WAIT_S = 20.0


@pytest.fixture
def changes() -> "queue.Queue[frozenset[Path]]":
    return queue.Queue()


@pytest.fixture
def watcher(changes: "queue.Queue[frozenset[Path]]") -> Iterator[FileWatcher]:
    made = FileWatcher(changes.put)
    yield made
    made.close()


def until_told(
    changes: "queue.Queue[frozenset[Path]]", path: Path, text: str
) -> frozenset[Path]:
    """Write until it is noticed: the watch may still be beginning."""
    deadline = time.monotonic() + WAIT_S
    while True:
        path.write_text(text)
        try:
            return changes.get(timeout=1.0)
        except queue.Empty:
            assert time.monotonic() < deadline


def test_a_file_and_a_folder_are_told_and_a_neighbour_is_not(
    tmp_path: Path,
    watcher: FileWatcher,
    changes: "queue.Queue[frozenset[Path]]",
) -> None:
    model = tmp_path / "model.gltf"
    folder = tmp_path / "shaders"
    (folder / "include").mkdir(parents=True)
    model.write_text("0")
    watcher.watch([model, folder])
    assert until_told(changes, model, "1") == {model.resolve()}
    (tmp_path / "other.txt").write_text("1")
    inner = folder / "include" / "a.glsl"
    told = until_told(changes, inner, "1")
    assert inner.resolve() in told
    assert tmp_path.resolve() / "other.txt" not in told


def test_a_file_that_is_replaced_is_told(
    tmp_path: Path,
    watcher: FileWatcher,
    changes: "queue.Queue[frozenset[Path]]",
) -> None:
    model = tmp_path / "model.gltf"
    model.write_text("0")
    watcher.watch([model])
    until_told(changes, model, "1")
    new = tmp_path / "new.tmp"
    new.write_text("2")
    os.replace(new, model)
    assert model.resolve() in changes.get(timeout=WAIT_S)


def test_nothing_is_told_after_the_end(
    tmp_path: Path,
    watcher: FileWatcher,
    changes: "queue.Queue[frozenset[Path]]",
) -> None:
    model = tmp_path / "model.gltf"
    model.write_text("0")
    watcher.watch([model])
    until_told(changes, model, "1")
    watcher.watch([])
    while not changes.empty():
        changes.get()
    model.write_text("2")
    with pytest.raises(queue.Empty):
        changes.get(timeout=1.0)


def test_what_lies_below_the_folder_of_a_file_is_not_watched(
    tmp_path: Path,
    watcher: FileWatcher,
    changes: "queue.Queue[frozenset[Path]]",
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    watched: list[str] = []
    whole = watchfiles.watch

    def watch(*folders: str | Path, **options: Any) -> Any:
        assert options["recursive"] is False
        watched.extend(map(str, folders))
        return whole(*folders, **options)

    monkeypatch.setattr(watchfiles, "watch", watch)
    (tmp_path / "all" / "of" / "a" / "disk").mkdir(parents=True)
    model = tmp_path / "model.gltf"
    model.write_text("0")
    watcher.watch([model])
    assert until_told(changes, model, "1") == {model.resolve()}
    assert watched == [str(tmp_path.resolve())]


def test_nobody_waits_for_a_watch_that_ends(
    tmp_path: Path,
    watcher: FileWatcher,
    changes: "queue.Queue[frozenset[Path]]",
) -> None:
    first, second = tmp_path / "first.gltf", tmp_path / "second.gltf"
    first.write_text("0")
    second.write_text("0")
    watcher.watch([first])
    assert until_told(changes, first, "1") == {first.resolve()}
    threads = threading.active_count()
    watcher.watch([second])
    # The one before has not looked yet: it does five times a second.
    assert threading.active_count() == threads + 1
    assert until_told(changes, second, "1") == {second.resolve()}
    first.write_text("2")
    assert until_told(changes, second, "2") == {second.resolve()}
    watcher.close()
    assert threading.active_count() == threads - 1
