"""Numbered files and moving pictures of a sequence."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from moka.app.frame_files import FrameFiles, frame_path, numbers_written
from moka.core.errors import ImageFileError
from moka.core.image import Image


def picture(value: float) -> Image:
    pixels = np.full((16, 24, 4), value, np.float32)
    pixels[..., 3] = 1
    return Image(pixels, tone_map="none")


def test_numbers_stand_before_the_ending_or_where_they_are_asked_for() -> None:
    for name, number, expected in (
        ("out.png", 7, "out.0007.png"),
        ("out.png", 12345, "out.12345.png"),
        ("out.v2.exr", 0, "out.v2.0000.exr"),
        ("##_out_###.png", 7, "##_out_007.png"),
        ("#.png", 10, "10.png"),
    ):
        path = frame_path(Path("folder#") / name, number)
        assert path == Path("folder#") / expected


def test_every_output_has_every_frame(tmp_path: Path) -> None:
    outputs = [tmp_path / name for name in ("a.png", "b.exr", "c.gif")]
    with FrameFiles(outputs, 10.0, half=True) as files:
        for number in range(3):
            files.write(number, picture(number / 4))
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        *(f"a.000{number}.png" for number in range(3)),
        *(f"b.000{number}.exr" for number in range(3)),
        "c.gif",
    }
    with PillowImage.open(tmp_path / "c.gif") as gif:
        assert gif.n_frames == 3
    assert numbers_written(outputs[:2], 5) == {0, 1, 2}
    (tmp_path / "b.0001.exr").unlink()
    assert numbers_written(outputs[:2], 5) == {0, 2}


def test_an_error_leaves_whole_frames_and_no_moving_picture(
    tmp_path: Path,
) -> None:
    outputs = [tmp_path / name for name in ("a.png", "c.gif", "d.webp")]

    def write() -> None:
        with FrameFiles(outputs, 10.0, half=False) as files:
            files.write(0, picture(0.25))
            files.write(1, picture(0.5))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write()
    names = {path.name for path in tmp_path.iterdir()}
    assert names <= {"a.0000.png", "a.0001.png"}
    assert "a.0000.png" in names
    for name in names:
        with PillowImage.open(tmp_path / name) as png:
            png.load()


@pytest.mark.parametrize("name", ["a.png", "a.gif"])
def test_a_file_that_cannot_be_written_ends_the_sequence(
    tmp_path: Path, name: str
) -> None:
    outputs = [tmp_path / "missing" / name]

    def write() -> None:
        with FrameFiles(outputs, 10.0, half=False) as files:
            for number in range(20):
                files.write(number, picture(0.5))

    with pytest.raises(ImageFileError, match="cannot write"):
        write()


def test_no_frames_are_no_files(tmp_path: Path) -> None:
    with FrameFiles([tmp_path / "a.png"], 10.0, half=False):
        pass
    assert list(tmp_path.iterdir()) == []
