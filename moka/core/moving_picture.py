"""Files of many pictures: GIF and WebP through Pillow, MP4 through ffmpeg.

A writer pulls its frames from an iterator, so that only a few are in memory
and the next one can be drawn while this one is encoded.
"""

import os
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from moka.core.atomic_file import image_file
from moka.core.errors import ImageFileError, OptionError

if TYPE_CHECKING:
    import PIL.Image

__all__ = ["MOVING_SUFFIXES", "check_moving_picture", "write_moving_picture"]

MOVING_SUFFIXES = (".gif", ".webp", ".mp4")

Pixels: TypeAlias = NDArray[np.uint8]

# Players show a GIF's frames of less than 2 hundredths of a second slower.
_FASTEST_GIF = 50.0

# The constant rate factor of x264 at which differences are not seen.
_RATE_FACTOR = "17"


def check_moving_picture(
    path: str | os.PathLike[str],
    size: tuple[int, int],
    frames_per_second: float,
    *,
    transparent: bool = False,
) -> None:
    """Raise what :func:`write_moving_picture` would, before the work is done.

    OptionError where the format has no such pictures, ImageFileError where a
    package is missing.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in MOVING_SUFFIXES:
        raise OptionError(
            f"{path}: moving pictures need one of the endings "
            f"{', '.join(MOVING_SUFFIXES)}"
        )
    if suffix == ".gif" and frames_per_second > _FASTEST_GIF:
        raise OptionError(
            f"{path}: a GIF shows {_FASTEST_GIF:g} frames per second at most, "
            f"not {frames_per_second:g}; use .webp or .mp4"
        )
    if suffix != ".mp4":
        return
    if transparent:
        raise OptionError(
            f"{path}: MP4 has no transparency; use .webp, or .png frames"
        )
    if any(side % 2 for side in size):
        raise OptionError(
            f"{path}: MP4 needs an even width and height, not "
            f"{size[0]}x{size[1]}"
        )
    _ffmpeg(path)


def write_moving_picture(
    path: str | os.PathLike[str],
    frames: Iterable[Pixels],
    frames_per_second: float,
) -> None:
    """Write ``frames`` as a .gif, .webp or .mp4 file, whole or not at all.

    Frames are sRGB-encoded uint8 (H, W, 4) of one size, alpha not
    associated, top row first. A GIF and a WebP repeat for ever. A GIF has
    256 colours a frame, and pixels that are there or not. What raises while
    frames are drawn is raised here. Raises OptionError and ImageFileError as
    :func:`check_moving_picture` does, and where the file cannot be written.
    """
    path = Path(path)
    remaining = iter(frames)
    first = next(remaining, None)
    if first is None:
        raise ValueError("a moving picture without frames cannot be written")
    height, width, _ = first.shape
    check_moving_picture(path, (width, height), frames_per_second)
    write = _WRITERS[path.suffix.lower()]
    with image_file(path) as temporary:
        write(temporary, chain([first], remaining), frames_per_second)


def _write_gif(path: Path, frames: Iterator[Pixels], rate: float) -> None:
    pictures = (_with_palette(frame) for frame in frames)
    # In hundredths of a second, which Pillow rounds to.
    _save_with_pillow(path, "GIF", pictures, rate, disposal=2, optimize=False)


def _write_webp(path: Path, frames: Iterator[Pixels], rate: float) -> None:
    from PIL import Image

    pictures = (Image.fromarray(frame, "RGBA") for frame in frames)
    _save_with_pillow(path, "WEBP", pictures, rate, quality=90, method=4)


def _save_with_pillow(
    path: Path,
    kind: str,
    pictures: "Iterator[PIL.Image.Image]",
    rate: float,
    **options: object,
) -> None:
    first = next(pictures)
    # Pillow leaves a file that it has opened open after an interruption.
    with path.open("w+b") as file:
        first.save(
            file,
            kind,
            save_all=True,
            append_images=pictures,
            duration=1000.0 / rate,
            loop=0,
            **options,
        )


def _with_palette(frame: Pixels) -> "PIL.Image.Image":
    """The frame in 256 colours of its own, 255 where it is transparent."""
    from PIL import Image

    picture = Image.fromarray(frame[:, :, :3], "RGB").quantize(
        255, Image.Quantize.MEDIANCUT
    )
    hidden = frame[:, :, 3] < 128
    if hidden.any():
        indices = np.array(picture)
        indices[hidden] = 255
        palette = picture.getpalette() or []
        picture = Image.fromarray(indices, "P")
        picture.putpalette(palette + [0] * (768 - len(palette)))
        picture.info["transparency"] = 255
    return picture


def _write_mp4(path: Path, frames: Iterator[Pixels], rate: float) -> None:
    import subprocess
    import tempfile

    first = next(frames)
    height, width, _ = first.shape
    # Without a matrix in the file players guess, and colours shift.
    colour = ("-color_primaries", "bt709", "-colorspace", "bt709")
    command = [
        *(_ffmpeg(path), "-loglevel", "error", "-y"),
        *("-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}"),
        *("-r", f"{rate:g}", "-i", "-", "-an"),
        *("-vf", "scale=out_color_matrix=bt709:out_range=tv"),
        *("-c:v", "libx264", "-preset", "medium", "-crf", _RATE_FACTOR),
        *("-pix_fmt", "yuv420p", *colour, "-color_trc", "iec61966-2-1"),
        *("-movflags", "+faststart", "-f", "mp4", str(path)),
    ]
    with (
        tempfile.TemporaryFile() as complaints,
        subprocess.Popen(
            command, stdin=subprocess.PIPE, stderr=complaints
        ) as encoder,
    ):
        assert encoder.stdin is not None
        try:
            for frame in chain([first], frames):
                encoder.stdin.write(np.ascontiguousarray(frame).data)
            encoder.stdin.close()
        except BrokenPipeError:
            pass  # It says why below.
        except BaseException:
            encoder.kill()
            raise
        if encoder.wait():
            complaints.seek(0)
            reason = complaints.read().decode(errors="replace").strip()
            last = reason.splitlines()[-1] if reason else "no reason given"
            raise OSError(f"ffmpeg: {last}")


def _ffmpeg(path: Path) -> str:
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError as error:
        raise ImageFileError(
            f"{path}: MP4 needs the package imageio-ffmpeg; "
            "pip install 'moka-pbr[video]'"
        ) from error
    try:
        program: str = get_ffmpeg_exe()
    except RuntimeError as error:
        raise ImageFileError(f"{path}: {error}") from error
    return program


_WRITERS = {".gif": _write_gif, ".webp": _write_webp, ".mp4": _write_mp4}
