"""Arrays on disk, found again by a key, safe for many processes.

An entry is one file:

    magic      8 bytes
    checksum   4 bytes, CRC-32 of all that follows
    length     4 bytes, of the header
    header     JSON: the key, and name, type, shape, offset of each array
    arrays     each at a multiple of 64 bytes, as NumPy lays them out in C

It is written under another name and renamed, so that a reader sees all of
it or nothing. What cannot be read back whole, by its checksum and its key,
is as good as absent and is replaced. Reading maps the file into memory,
which stays valid when another process replaces or deletes it.
"""

import mmap
import os
import sys
import time
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.atomic_file import atomic_file
from moka.core.log import get_logger

__all__ = ["DEFAULT_LIMIT", "DiskCache", "Usage", "cache_folder"]

_LOGGER = get_logger(__name__)

#: Bytes that a cache may fill: sixty environments of 1024 x 512.
DEFAULT_LIMIT = 512 << 20

_MAGIC = b"moka-la1"
_SUFFIX = ".lighting"
_ALIGNMENT = 64
_PREFIX = len(_MAGIC) + 8
# A file that a writer left behind when it was killed.
_ABANDONED_SECONDS = 3600.0

Arrays = Mapping[str, NDArray[Any]]


class Usage(Struct, frozen=True):
    """How many entries there are and how many bytes they fill."""

    entries: int
    size: int


def cache_folder() -> Path:
    """Where caches of moka belong.

    The environment variable MOKA_CACHE_DIR, else the folder ``moka`` where
    the system keeps caches: XDG_CACHE_HOME or ~/.cache, ~/Library/Caches on
    macOS, LOCALAPPDATA on Windows. Three rules are no reason to depend on a
    package and to wait for its import.
    """
    chosen = os.environ.get("MOKA_CACHE_DIR")
    if chosen:
        return Path(chosen)
    # By the standard a relative path is to be ignored.
    base = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(base):
        home = os.path.expanduser("~")
        if sys.platform == "win32":
            base = os.environ.get("LOCALAPPDATA") or home
        elif sys.platform == "darwin":
            base = os.path.join(home, "Library", "Caches")
        else:
            base = os.path.join(home, ".cache")
    return Path(base, "moka")


class DiskCache:
    """Entries of arrays in one folder, the least recently used deleted.

    ``limit`` is in bytes. Nothing here raises for a folder that is missing,
    full or forbidden: a cache that cannot be used is an empty one.
    """

    def __init__(
        self, folder: Path | None = None, limit: int = DEFAULT_LIMIT
    ) -> None:
        self.folder = cache_folder() if folder is None else folder
        self.limit = limit

    def load(self, key: str) -> dict[str, NDArray[Any]] | None:
        """The arrays of ``key``, read-only, or None if it is not there.

        ``key`` consists of letters and digits.
        """
        path = self._path(key)
        try:
            with path.open("rb") as file:
                data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        except (OSError, ValueError):  # an empty file cannot be mapped
            return None
        try:
            arrays = _parse(data, key)
        except (
            ValueError,
            KeyError,
            TypeError,
            msgspec.DecodeError,
        ) as error:
            _LOGGER.info("%s: is no entry of the cache: %s", path, error)
            return None
        with suppress(OSError):
            os.utime(path)  # used now
        return arrays

    def store(self, key: str, arrays: Arrays) -> None:
        """Keep ``arrays`` (of plain numbers) under ``key``."""
        head, contents = _pack(key, arrays)
        size = len(head) + sum(map(len, contents))
        if size > self.limit:
            _LOGGER.info("cache: an entry of %d bytes is too large", size)
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with (
                atomic_file(self._path(key)) as temporary,
                temporary.open("wb") as file,
            ):
                file.write(head)
                file.writelines(contents)
        except OSError as error:
            _LOGGER.info("%s: cannot write the cache: %s", self.folder, error)
            return
        self._prune()

    def usage(self) -> Usage:
        """What the cache holds now."""
        sizes = [size for _, size, _ in self._entries()]
        return Usage(len(sizes), sum(sizes))

    def clear(self) -> Usage:
        """Delete every entry and nothing else; what has been deleted."""
        deleted = [size for path, size, _ in self._entries() if _deleted(path)]
        for path in self._unfinished():
            _deleted(path)
        return Usage(len(deleted), sum(deleted))

    def _path(self, key: str) -> Path:
        if not (key.isascii() and key.isalnum()):
            raise ValueError(f"{key!r} is no key of a cache")
        return self.folder / f"{key}{_SUFFIX}"

    def _prune(self) -> None:
        """Delete the least recently used entries beyond the limit."""
        entries = sorted(self._entries(), key=lambda entry: -entry[2])
        total = 0
        for path, size, _ in entries:
            total += size
            if total > self.limit:
                _deleted(path)
        long_ago = time.time() - _ABANDONED_SECONDS
        for path in self._unfinished():
            with suppress(OSError):
                if path.stat().st_mtime < long_ago:
                    path.unlink()

    def _entries(self) -> list[tuple[Path, int, float]]:
        """Path, bytes and time of the last use of every entry."""
        found = []
        for path in self.folder.glob(f"*{_SUFFIX}"):
            with suppress(OSError):  # another process has just deleted it
                status = path.stat()
                found.append((path, status.st_size, status.st_mtime))
        return found

    def _unfinished(self) -> list[Path]:
        return list(self.folder.glob(".moka-*.tmp"))


def _pack(key: str, arrays: Arrays) -> tuple[bytes, list[bytes | memoryview]]:
    """The head of an entry, and what follows it."""
    contiguous = {
        name: np.asarray(array, order="C") for name, array in arrays.items()
    }
    places, offset = [], 0
    contents: list[bytes | memoryview] = []
    for name, array in contiguous.items():
        places.append([name, array.dtype.str, array.shape, offset])
        padding = -array.nbytes % _ALIGNMENT
        contents += [array.reshape(-1).view(np.uint8).data, bytes(padding)]
        offset += array.nbytes + padding
    header = msgspec.json.encode({"key": key, "size": offset, "arrays": places})
    # Spaces are nothing to JSON; the arrays begin at a whole line of a cache.
    header += b" " * (-(_PREFIX + len(header)) % _ALIGNMENT)
    rest = len(header).to_bytes(4, "little") + header
    checksum = zlib.crc32(rest)
    for content in contents:
        checksum = zlib.crc32(content, checksum)
    return _MAGIC + checksum.to_bytes(4, "little") + rest, contents


def _parse(data: mmap.mmap, key: str) -> dict[str, NDArray[Any]]:
    """The arrays of an entry, as views; raises ValueError if it is none."""
    view = memoryview(data)
    magic = len(_MAGIC)
    if len(view) < _PREFIX or view[:magic] != _MAGIC:
        raise ValueError("it begins otherwise")
    checksum = int.from_bytes(view[magic : magic + 4], "little")
    if zlib.crc32(view[magic + 4 :]) != checksum:
        raise ValueError("it is damaged")
    start = _PREFIX + int.from_bytes(view[magic + 4 : _PREFIX], "little")
    header = msgspec.json.decode(view[_PREFIX:start])
    if header["key"] != key:
        raise ValueError("it is that of another key")
    return {
        name: np.ndarray(tuple(shape), np.dtype(dtype), data, start + offset)
        for name, dtype, shape, offset in header["arrays"]
    }


def _deleted(path: Path) -> bool:
    """Delete ``path``; whether it was there to be deleted."""
    try:
        path.unlink()
    except OSError:
        return False
    return True
