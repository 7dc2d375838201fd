"""The cache on disk: whatever lies in its folder, nothing wrong comes out."""

import logging
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from moka.lighting.disk_cache import DiskCache, Usage, cache_folder

ARRAYS = {
    "cube": np.arange(6 * 4 * 4 * 4, dtype=np.float32).reshape(6, 4, 4, 4),
    "harmonics": np.linspace(-1, 1, 27).reshape(9, 3),
    "nothing": np.empty((0, 7)),
}


@pytest.fixture
def cache(tmp_path: Path) -> DiskCache:
    return DiskCache(tmp_path / "cache")


def entry(cache: DiskCache, key: str = "a") -> Path:
    return cache.folder / f"{key}.lighting"


def holds(cache: DiskCache, key: str = "a") -> bool:
    found = cache.load(key)
    if found is None:
        return False
    assert found.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found[name], array, strict=True)
        assert not found[name].flags.writeable
    return True


def test_what_was_stored_comes_back(cache: DiskCache) -> None:
    assert cache.load("a") is None
    cache.store("a", ARRAYS)
    assert holds(cache)
    assert cache.load("b") is None
    assert DiskCache(cache.folder).load("a") is not None


@settings(max_examples=40)
@given(
    arrays_of.arrays(
        st.sampled_from([np.float32, np.float64, np.uint8, np.int16]),
        arrays_of.array_shapes(min_dims=0, max_dims=4, min_side=0),
    ),
    st.booleans(),
)
def test_every_array_survives(
    tmp_path_factory: pytest.TempPathFactory,
    array: np.ndarray,
    transposed: bool,
) -> None:
    cache = DiskCache(tmp_path_factory.mktemp("cache"))
    given_array = array.T if transposed else array
    cache.store("k", {"first": np.ones(3), "array": given_array})
    found = cache.load("k")
    assert found is not None
    assert found["array"].dtype == given_array.dtype
    assert found["array"].shape == given_array.shape
    assert found["array"].tobytes() == given_array.tobytes()


def test_every_shortened_entry_is_ignored_and_replaced(
    cache: DiskCache,
) -> None:
    cache.store("a", ARRAYS)
    whole = entry(cache).read_bytes()
    for length in (0, 1, 7, 8, 12, 15, 16, 60, len(whole) // 2, len(whole) - 1):
        entry(cache).write_bytes(whole[:length])
        assert cache.load("a") is None
    entry(cache).write_bytes(whole + b"more")
    assert cache.load("a") is None
    cache.store("a", ARRAYS)
    assert holds(cache)


@given(st.data())
def test_any_changed_byte_is_noticed(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    cache = DiskCache(tmp_path_factory.mktemp("cache"))
    cache.store("a", ARRAYS)
    content = bytearray(entry(cache).read_bytes())
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] ^= data.draw(st.integers(1, 255))
    entry(cache).write_bytes(content)
    assert cache.load("a") is None


@pytest.mark.parametrize(
    "content", [b"", b"moka-la1", b"GIF89a" + bytes(100), bytes(4096)]
)
def test_a_foreign_file_is_ignored_and_replaced(
    cache: DiskCache, content: bytes
) -> None:
    cache.folder.mkdir()
    entry(cache).write_bytes(content)
    assert cache.load("a") is None
    cache.store("a", ARRAYS)
    assert holds(cache)


def test_an_entry_under_another_name_is_ignored(cache: DiskCache) -> None:
    cache.store("a", ARRAYS)
    entry(cache).rename(entry(cache, "b"))
    assert cache.load("b") is None


def test_arrays_stay_when_the_entry_goes(cache: DiskCache) -> None:
    cache.store("a", ARRAYS)
    found = cache.load("a")
    assert found is not None
    cache.store("a", {"cube": np.zeros(4)})
    assert cache.clear().entries == 1
    np.testing.assert_array_equal(found["cube"], ARRAYS["cube"])


def test_the_least_recently_used_goes_first(cache: DiskCache) -> None:
    content = {"bytes": np.zeros(1000, np.uint8)}
    cache.store("a", content)
    size = cache.usage().size
    cache.limit = 3 * size
    for number, key in enumerate("bc"):
        cache.store(key, content)
        os.utime(entry(cache, key), (1000 + number, 1000 + number))
    os.utime(entry(cache, "a"), (999, 999))
    assert cache.load("a") is not None  # makes it the latest
    cache.store("d", content)
    assert cache.usage() == Usage(3, 3 * size)
    assert [cache.load(key) is not None for key in "abcd"] == [
        True,
        False,
        True,
        True,
    ]


def test_what_is_larger_than_the_limit_is_not_stored(cache: DiskCache) -> None:
    cache.store("a", ARRAYS)
    cache.limit = cache.usage().size + 10
    cache.store("b", {"bytes": np.zeros(10000, np.uint8)})
    assert cache.load("b") is None
    assert holds(cache)


def test_clearing_leaves_what_is_not_ours(cache: DiskCache) -> None:
    assert cache.clear() == cache.usage() == Usage(0, 0)
    cache.store("a", ARRAYS)
    other = cache.folder / "notes.txt"
    other.write_text("mine")
    half = cache.folder / ".moka-0123.tmp"
    half.write_bytes(b"half of it")
    size = cache.usage().size
    assert cache.clear() == Usage(1, size)
    assert list(cache.folder.iterdir()) == [other]


def test_what_a_killed_writer_left_is_swept_later(cache: DiskCache) -> None:
    cache.store("a", ARRAYS)
    old = cache.folder / ".moka-old.tmp"
    young = cache.folder / ".moka-young.tmp"
    for path in (old, young):
        path.write_bytes(b"half of it")
    long_ago = time.time() - 7200
    os.utime(old, (long_ago, long_ago))
    cache.store("b", ARRAYS)
    assert not old.exists()
    assert young.exists()


def test_a_folder_that_cannot_be_is_an_empty_cache(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("no folder")
    cache = DiskCache(tmp_path / "file" / "cache")
    with caplog.at_level(logging.INFO, "moka"):
        cache.store("a", ARRAYS)
    assert "cannot write the cache" in caplog.text
    assert cache.load("a") is None
    assert cache.usage() == cache.clear() == Usage(0, 0)


@pytest.mark.parametrize("key", ["", "../a", "a/b", "a.b", "ä"])
def test_a_key_is_no_path(cache: DiskCache, key: str) -> None:
    with pytest.raises(ValueError, match="no key"):
        cache.load(key)


WRITER = """
import sys
from pathlib import Path
import numpy as np
from moka.lighting.disk_cache import DiskCache
cache = DiskCache(Path(sys.argv[1]))
for number in range(60):
    cache.store("a", {"x": np.full(20000, int(sys.argv[2]), np.uint8)})
    found = cache.load("a")
    if found is not None:
        assert len(set(found["x"].tolist())) == 1
    if number % 20 == 19:
        cache.clear()
"""


def test_many_processes_never_see_half_an_entry(tmp_path: Path) -> None:
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path), str(number)],
            stderr=subprocess.PIPE,
        )
        for number in range(3)
    ]
    for process in processes:
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 0, errors.decode()
    assert not [path for path in tmp_path.iterdir() if path.suffix == ".tmp"]


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="XDG")
def test_where_the_cache_belongs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/someone")
    monkeypatch.delenv("MOKA_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert cache_folder() == Path("/home/someone/.cache/moka")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_folder() == Path("/home/someone/.cache/moka")
    monkeypatch.setenv("XDG_CACHE_HOME", "/var/tmp/caches")
    assert cache_folder() == Path("/var/tmp/caches/moka")
    monkeypatch.setenv("MOKA_CACHE_DIR", "/elsewhere")
    assert cache_folder() == Path("/elsewhere")
