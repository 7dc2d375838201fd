"""Writes a picture into several files: all of them, or none."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from moka.app.render import Picture
from moka.core.atomic_file import atomic_file
from moka.core.errors import ImageFileError

__all__ = ["SUFFIXES", "write_outputs"]

SUFFIXES = (".png", ".exr")


def write_outputs(
    picture: Picture, paths: Sequence[Path], *, half: bool = False
) -> None:
    """Write ``picture`` to .png (display) and .exr (radiance) files.

    Every file is finished before the first one appears. ``half`` stores the
    radiance as half floats. Raises ImageFileError, naming the file.
    """
    with ExitStack() as files:
        for path in paths:
            try:
                temporary = files.enter_context(atomic_file(path))
                _write(picture, path.suffix.lower(), temporary, half=half)
            except OSError as error:
                raise ImageFileError(
                    f"{path}: cannot write the image: {error.strerror}"
                ) from error


def _write(picture: Picture, suffix: str, target: Path, *, half: bool) -> None:
    if suffix == ".png":
        from moka.core.png import encode_png

        assert picture.display is not None
        target.write_bytes(encode_png(picture.display))
    else:
        from moka.core.exr import write_exr

        assert picture.pixels is not None
        write_exr(target, picture.pixels, half=half)
