"""Moving pictures, written here and decoded by someone else."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from moka.core.errors import ImageFileError, OptionError
from moka.core.moving_picture import (
    check_moving_picture,
    write_moving_picture,
)

SIZE = (48, 32)
COUNT = 5


def frames(alpha: int = 255) -> Iterator[NDArray[np.uint8]]:
    """Each of one colour, with a square of ``alpha`` in the corner."""
    for number in range(COUNT):
        frame = np.full((SIZE[1], SIZE[0], 4), 255, np.uint8)
        frame[:, :, :3] = colour(number)
        frame[:16, :16, 3] = alpha
        yield frame


def colour(number: int) -> tuple[int, int, int]:
    return 40 + 40 * number, 200 - 30 * number, 120


@pytest.mark.parametrize("suffix", [".gif", ".webp"])
def test_frames_of_gif_and_webp(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"moving{suffix}"
    write_moving_picture(path, frames(alpha=0), 20.0)
    with Image.open(path) as picture:
        assert picture.size == SIZE
        assert picture.n_frames == COUNT
        assert picture.info["loop"] == 0
        for number in range(COUNT):
            picture.seek(number)
            shown = np.asarray(picture.convert("RGBA")).astype(int)
            assert picture.info["duration"] == 50
            difference = shown[20:, 20:, :3] - colour(number)
            assert np.abs(difference).max() <= 3
            assert (shown[:15, :15, 3] == 0).all()
            assert (shown[17:, 17:, 3] == 255).all()


def test_frames_of_mp4(tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg").get_ffmpeg_exe()
    path = tmp_path / "moving.mp4"
    write_moving_picture(path, frames(), 25.0)
    decoded = subprocess.run(
        [
            *(ffmpeg, "-loglevel", "error", "-i", str(path)),
            *("-f", "rawvideo", "-pix_fmt", "rgb24", "-"),
        ],
        capture_output=True,
        check=True,
    ).stdout
    shown = np.frombuffer(decoded, np.uint8).reshape(COUNT, *SIZE[::-1], 3)
    for number in range(COUNT):
        difference = shown[number].astype(int) - colour(number)
        assert np.abs(difference).max() <= 3


def test_what_fails_while_drawing_leaves_nothing(tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")

    def failing() -> Iterator[NDArray[np.uint8]]:
        yield from list(frames())[:2]
        raise RuntimeError("no third frame")

    for suffix in (".gif", ".webp", ".mp4"):
        with pytest.raises(RuntimeError, match="no third frame"):
            write_moving_picture(tmp_path / f"m{suffix}", failing(), 10.0)
    assert list(tmp_path.iterdir()) == []


def test_what_a_format_cannot_is_told_before_the_work() -> None:
    for path, size, rate, transparent, text in (
        ("a.avi", SIZE, 24.0, False, "endings .gif, .webp, .mp4"),
        ("a.gif", SIZE, 60.0, False, "50 frames per second at most"),
        ("a.mp4", (31, 32), 24.0, False, "even width and height, not 31x32"),
        ("a.mp4", SIZE, 24.0, True, "has no transparency"),
    ):
        with pytest.raises(OptionError) as caught:
            check_moving_picture(path, size, rate, transparent=transparent)
        assert text in str(caught.value)
        assert path in str(caught.value)


def test_a_missing_encoder_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ImageFileError, match=r"moka-pbr\[video\]"):
        check_moving_picture("a.mp4", SIZE, 24.0)


def test_a_folder_that_is_missing_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "a.gif"
    with pytest.raises(ImageFileError, match="cannot write"):
        write_moving_picture(path, frames(), 10.0)
