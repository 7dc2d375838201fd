"""Pictures: what is saved is what was asked for."""

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from moka.core.colour import encode_srgb
from moka.core.errors import ImageFileError, OptionError
from moka.core.exr import read_exr
from moka.core.image import Image
from moka.core.tone_map import TONE_MAPS, tone_map


def radiance() -> np.ndarray:
    pixels = np.random.default_rng(1).uniform(0.0, 2.0, (37, 20, 4))
    pixels[:, :, 3] = 1.0
    return pixels.astype(np.float32)


def test_size_is_width_and_height() -> None:
    image = Image(radiance())
    assert image.size == (20, 37)
    assert repr(image) == "Image(20 x 37)"


@pytest.mark.parametrize("name", TONE_MAPS)
def test_display_is_exposed_mapped_and_encoded(name: str) -> None:
    pixels = radiance()
    shown = Image(pixels).to_display(name, exposure=-1.0)
    mapped = tone_map(pixels[:, :, :3].astype(float), name, exposure=-1.0)
    exact = 255.0 * encode_srgb(mapped)
    assert np.abs(shown[:, :, :3] - exact).max() < 0.51
    assert (shown[:, :, 3] == 255).all()


def test_alpha_is_taken_out_of_the_colour() -> None:
    pixels = radiance()
    alpha = np.linspace(0.0, 1.0, 37 * 20).reshape(37, 20, 1)
    associated = pixels * alpha.astype(np.float32)
    shown = Image(associated).to_display()
    opaque = Image(pixels).to_display()
    assert (shown[0, 0] == 0).all()
    difference = shown[:, :, :3].astype(int) - opaque[:, :, :3]
    assert np.abs(difference.reshape(-1, 3)[1:]).max() <= 1
    np.testing.assert_array_equal(
        shown[:, :, 3:], np.rint(255.0 * alpha).astype(np.uint8)
    )


def test_gamma_replaces_the_srgb_curve() -> None:
    pixels = np.full((1, 1, 4), 0.5, np.float32)
    shown = Image(pixels).to_display("none", gamma=2.2)
    # The pixel is half transparent white.
    assert shown.tolist() == [[[255, 255, 255, 128]]]
    pixels[:, :, 3] = 1.0
    shown = Image(pixels).to_display("none", gamma=2.0)
    assert shown[0, 0, 0] == round(255 * 0.5**0.5)
    with pytest.raises(OptionError, match="gamma"):
        Image(pixels).to_display(gamma=0.0)


def test_what_the_gpu_made_is_used_only_where_it_fits() -> None:
    display = np.full((37, 20, 4), 9, np.uint8)
    image = Image(radiance(), tone_map="aces", exposure=1.0, display=display)
    assert image.to_display() is display
    assert image.to_display("aces", 1.0) is display
    other = Image(radiance(), tone_map="aces", exposure=1.0)
    for arguments in [("agx",), ("aces", 0.0), (None, None, 2.2)]:
        np.testing.assert_array_equal(
            image.to_display(*arguments), other.to_display(*arguments)
        )


def test_png_is_the_display_picture(tmp_path: Path) -> None:
    image = Image(radiance(), tone_map="agx", exposure=0.5)
    image.save(tmp_path / "a.PNG")
    with PillowImage.open(tmp_path / "a.PNG") as file:
        np.testing.assert_array_equal(file, image.to_display()[:, :, :3])
    image.save(tmp_path / "b.png", tone_map="none")
    with PillowImage.open(tmp_path / "b.png") as file:
        shown = image.to_display("none")
        np.testing.assert_array_equal(file, shown[:, :, :3])


def test_exr_is_radiance_whatever_the_exposure(tmp_path: Path) -> None:
    pixels = radiance()
    depth = pixels[:, :, 0]
    image = Image(pixels, exposure=3.0, layers={"depth.Z": depth})
    image.save(tmp_path / "a.exr", exposure=2.0)
    read, layers = read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(read, pixels)
    np.testing.assert_array_equal(layers["depth.Z"], depth)


def test_several_files_are_written_or_none(tmp_path: Path) -> None:
    image = Image(radiance())
    image.save_all([tmp_path / "a.png", tmp_path / "a.exr"], half=True)
    assert {path.name for path in tmp_path.iterdir()} == {"a.png", "a.exr"}

    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for bad in ("missing/b.exr", "missing/b.png", "b.jpg"):
        with pytest.raises(ImageFileError, match=bad):
            image.save_all(
                [tmp_path / "a.png", tmp_path / "c.exr", tmp_path / bad],
                tone_map="none",
            )
        after = {path: path.read_bytes() for path in tmp_path.iterdir()}
        assert after == before


def test_picture_for_a_display_only(tmp_path: Path) -> None:
    display = np.full((3, 2, 4), 200, np.uint8)
    image = Image(None, display=display)
    assert image.size == (2, 3)
    image.save(tmp_path / "a.png")
    with pytest.raises(ImageFileError, match="display only"):
        image.save(tmp_path / "a.exr")
    with pytest.raises(ImageFileError, match="display only"):
        image.to_display("aces")


def test_notebooks_show_a_png() -> None:
    image = Image(radiance())
    with PillowImage.open(io.BytesIO(image._repr_png_())) as file:
        np.testing.assert_array_equal(file, image.to_display()[:, :, :3])


def test_other_suffixes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ImageFileError, match=r"a\.jpg: .*\.png or \.exr"):
        Image(radiance()).save(tmp_path / "a.jpg")
    assert not list(tmp_path.iterdir())


def test_wrong_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="RGBA"):
        Image(np.zeros((2, 2, 3), np.float32))
    with pytest.raises(ValueError, match="differ in size"):
        Image(radiance(), display=np.zeros((2, 2, 4), np.uint8))


def test_import_takes_no_image_library_along() -> None:
    check = (
        "import sys, moka.core.image;"
        "sys.exit(bool({'PIL', 'OpenEXR'} & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", check], check=True)
