"""Pictures read back as what they hold, and as what a display shows."""

from pathlib import Path

import numpy as np
import pytest

from moka.core.errors import ImageFileError, OptionError
from moka.core.exr import write_exr
from moka.core.image import Image
from moka.core.picture_file import read_picture
from moka.core.png import write_png


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_every_layout_becomes_rgba(channels: int, tmp_path: Path) -> None:
    codes = np.random.default_rng(channels).integers(
        0, 256, (3, 5, channels), np.uint8
    )
    write_png(tmp_path / "a.png", codes)
    picture = read_picture(tmp_path / "a.png")
    colour = codes[:, :, : channels - (channels in (2, 4))]
    alpha = codes[:, :, -1] if channels in (2, 4) else 255
    assert picture.pixels.dtype == np.float32
    assert picture.size == (5, 3)
    assert not picture.linear
    restored = np.rint(picture.pixels * 255)
    assert (restored[:, :, :3] == colour).all()
    assert (restored[:, :, 3] == alpha).all()


def test_radiance_stays_as_it_is(tmp_path: Path) -> None:
    pixels = np.random.default_rng(1).normal(0, 9, (3, 5, 4))
    write_exr(tmp_path / "a.exr", pixels.astype(np.float32))
    picture = read_picture(str(tmp_path / "a.exr"))
    assert picture.linear
    assert (picture.pixels == pixels.astype(np.float32)).all()


def test_what_is_shown_is_what_a_png_would_hold(tmp_path: Path) -> None:
    pixels = np.random.default_rng(1).random((3, 5, 4), np.float32)
    write_exr(tmp_path / "a.exr", pixels)
    shown = read_picture(tmp_path / "a.exr").shown("agx", 1.5)
    codes = Image(pixels).to_display("agx", 1.5)
    assert not shown.linear
    assert (np.rint(shown.pixels * 255) == codes).all()
    assert shown.shown("aces") is shown
    with pytest.raises(OptionError, match="unknown tone map"):
        read_picture(tmp_path / "a.exr").shown("none such")


def test_faults_name_the_file(tmp_path: Path) -> None:
    pixels = np.zeros((3, 5, 4), np.float32)
    pixels[1, 4, 2] = np.inf
    write_exr(tmp_path / "a.exr", pixels)
    (tmp_path / "b.png").write_bytes(b"\xff\xd8\xff")
    for name, message in (
        ("a.exr", "not finite: 1, the first in column 4 of row 1"),
        ("b.png", "cannot decode"),
        ("c.png", "cannot read the picture: No such file"),
        ("c.exr", "no such file"),
        ("c.tiff", "of this kind; use .png, .jpg, .jpeg, .exr"),
    ):
        with pytest.raises(ImageFileError) as caught:
            read_picture(tmp_path / name)
        assert str(caught.value).startswith(f"{tmp_path / name}: ")
        assert message in str(caught.value)
