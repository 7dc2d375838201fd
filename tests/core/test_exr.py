"""EXR files: bits that come back, layers, and every way of being broken."""

import os
from pathlib import Path

import numpy as np
import pytest

from moka.core.errors import ImageFileError
from moka.core.exr import EXR_COMPRESSIONS, read_exr, write_exr

RANDOM = np.random.default_rng(5)


def radiance(height: int = 20, width: int = 12) -> np.ndarray:
    values = RANDOM.uniform(0.0, 1.0, (height, width, 4)) ** 8 * 1e5
    return values.astype(np.float32)


@pytest.mark.parametrize("compression", [None, "none", "rle", "zip", "piz"])
def test_float_pixels_come_back(
    tmp_path: Path, compression: str | None
) -> None:
    pixels = radiance()
    pixels[0, 0] = [np.inf, -1.0, 1e-42, 1e30]
    write_exr(tmp_path / "a.exr", pixels, compression=compression)
    read, layers = read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(read, pixels)
    assert not layers


@pytest.mark.parametrize("compression", EXR_COMPRESSIONS)
def test_every_compression_is_near(tmp_path: Path, compression: str) -> None:
    pixels = np.ones((32, 32, 4), np.float32) * 0.5
    write_exr(tmp_path / "a.exr", pixels, compression=compression)
    np.testing.assert_allclose(read_exr(tmp_path / "a.exr")[0], pixels, 1e-2)


def test_half_pixels_round_and_end_at_the_largest(tmp_path: Path) -> None:
    pixels = radiance()
    pixels[0, 0] = [np.inf, 1e9, -1e9, 65504.0]
    write_exr(tmp_path / "a.exr", pixels, half=True)
    expected = np.clip(pixels, -65504, 65504).astype(np.float16)
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr")[0], expected)


def test_rows_may_lie_anywhere_in_memory(tmp_path: Path) -> None:
    pixels = radiance()[::-1, ::2]
    write_exr(tmp_path / "a.exr", pixels[:, :, :3])
    read, _ = read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(read[:, :, :3], pixels[:, :, :3])
    assert (read[:, :, 3] == 1.0).all()


def test_layers_come_back_by_name(tmp_path: Path) -> None:
    pixels = radiance()
    depth = pixels[:, :, 0].copy()
    depth[3, 3] = np.inf
    layers = {
        "depth.Z": depth,
        "normal.XYZ": pixels[:, :, :3] - 0.5,
        "albedo.RGB": (pixels[::-1, :, :3] / 2.0).astype(np.float16),
        "object-id": np.arange(240, dtype=np.uint32).reshape(20, 12),
        "motion.UV": pixels[:, :, 1:3],
    }
    write_exr(tmp_path / "a.exr", pixels, half=True, layers=layers)
    _, read = read_exr(tmp_path / "a.exr")
    assert set(read) == set(layers)
    for name, layer in layers.items():
        np.testing.assert_array_equal(read[name], layer)
    assert read["object-id"].dtype == np.uint32


def test_layer_of_another_size_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'depth'"):
        write_exr(
            tmp_path / "a.exr",
            radiance(),
            layers={"depth": np.zeros((3, 3), np.float32)},
        )


def test_unknown_compression_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="'lzw'"):
        write_exr(tmp_path / "a.exr", radiance(), compression="lzw")


def write_channels(path: Path, **channels: np.ndarray) -> None:
    import OpenEXR

    OpenEXR.File({"type": OpenEXR.scanlineimage}, channels).write(str(path))


def test_luminance_becomes_grey(tmp_path: Path) -> None:
    plane = radiance()[:, :, 0].copy()
    write_channels(tmp_path / "a.exr", Y=plane)
    read, _ = read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(read[:, :, 1], plane)


def test_file_without_colour_names_what_it_has(tmp_path: Path) -> None:
    write_channels(tmp_path / "a.exr", Z=radiance()[:, :, 0].copy())
    with pytest.raises(ImageFileError, match=r"a\.exr: .*but Z"):
        read_exr(tmp_path / "a.exr")


def test_every_truncation_is_an_error(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.exr"
    write_exr(path, radiance(), compression="zip")
    data = path.read_bytes()
    for size in [*range(0, 400, 7), *range(400, len(data), 97)]:
        path.write_bytes(data[:size])
        with pytest.raises(ImageFileError) as error:
            read_exr(path)
        assert str(error.value).startswith(f"{path}: ")
        assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


def test_corrupt_pixels_are_a_silent_error(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.exr"
    write_exr(path, np.ones((99, 99, 4), np.float32), compression="zip")
    data = bytearray(path.read_bytes())
    data[-60:-20] = bytes(40)
    path.write_bytes(data)
    with pytest.raises(ImageFileError, match=r"a\.exr: "):
        read_exr(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["missing.exr", "."])
def test_unreadable_path_is_an_error(tmp_path: Path, name: str) -> None:
    with pytest.raises(ImageFileError, match=r"no such file|directory"):
        read_exr(tmp_path / name)


def test_failed_write_leaves_nothing(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "a.exr"
    with pytest.raises(ImageFileError, match=r"a\.exr: .*No such file"):
        write_exr(path, radiance())
    assert os.listdir(tmp_path) == []
