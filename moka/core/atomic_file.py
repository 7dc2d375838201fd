"""Files that appear whole or not at all."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from moka.core.errors import ImageFileError

__all__ = ["atomic_file", "image_file"]


@contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Gives an empty file to write to, which becomes ``path`` at the end.

    It lies in the same folder, since only there is the exchange atomic. If
    the block raises, it is removed and ``path`` stays as it was. A link is
    followed; a pipe or a device is written to directly. Raises OSError at
    once where ``path`` cannot be written.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(
            errno.EISDIR, os.strerror(errno.EISDIR), str(path)
        )
    if target.exists() and not target.is_file():
        yield target
        return
    temporary = target.with_name(f".moka-{os.urandom(8).hex()}.tmp")
    temporary.touch(exist_ok=False)
    try:
        yield temporary
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def image_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """:func:`atomic_file` for images: OSErrors become ImageFileErrors."""
    try:
        with atomic_file(path) as temporary:
            yield temporary
    except OSError as error:
        raise ImageFileError(
            f"{os.fspath(path)}: cannot write the image: "
            f"{error.strerror or error}"
        ) from error
