"""Authors and copyright from each kind of picture file."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage
from PIL.PngImagePlugin import PngInfo

from moka.core.errors import ImageFileError
from moka.core.exr import write_exr
from moka.core.picture_credits import picture_credits


def test_png_text(tmp_path: Path) -> None:
    text = PngInfo()
    text.add_text("Author", " Ada ", zip=True)
    text.add_itxt("Copyright", "© Ada", lang="en")
    text.add_text("Comment", "not this")
    path = tmp_path / "a.png"
    PillowImage.new("RGB", (4, 4)).save(path, pnginfo=text)
    assert picture_credits(path) == ["Ada", "© Ada"]


def test_jpeg_exif(tmp_path: Path) -> None:
    exif = PillowImage.Exif()
    exif[0x013B] = "Ada"
    exif[0x8298] = "(c) Ada"
    exif[0x0131] = "not this"
    path = tmp_path / "a.jpg"
    PillowImage.new("RGB", (4, 4)).save(path, exif=exif)
    assert picture_credits(path) == ["Ada", "(c) Ada"]


def test_exr_owner(tmp_path: Path) -> None:
    import OpenEXR

    path = tmp_path / "a.exr"
    pixels = np.zeros((2, 2, 3), np.float32)
    header = {"type": OpenEXR.scanlineimage, "owner": "Ada"}
    OpenEXR.File(header, {"RGB": pixels}).write(str(path))
    assert picture_credits(path) == ["Ada"]


def test_none(tmp_path: Path) -> None:
    PillowImage.new("RGB", (4, 4)).save(tmp_path / "a.png")
    PillowImage.new("RGB", (4, 4)).save(tmp_path / "a.jpg")
    write_exr(tmp_path / "a.exr", np.zeros((2, 2, 3), np.float32))
    for name in ("a.png", "a.jpg", "a.exr"):
        assert picture_credits(tmp_path / name) == []


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.exr"])
def test_faults_name_the_file(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with pytest.raises(ImageFileError, match=f"{name}: cannot read the meta"):
        picture_credits(path)
    path.write_bytes(b"\xff\xd8\xffbroken")
    with pytest.raises(ImageFileError, match=f"{name}: cannot read the meta"):
        picture_credits(path)
