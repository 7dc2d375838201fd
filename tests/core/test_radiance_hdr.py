"""Radiance pictures: headers, orientations, and every way to break one."""

from pathlib import Path

import numpy as np
import pytest

from moka.core.errors import EnvironmentMapError, ImageFileError
from moka.core.radiance_hdr import (
    parse_radiance_hdr,
    read_radiance_hdr,
    write_radiance_hdr,
)
from moka.core.rgbe import decode_rgbe, encode_rgbe


def radiance(height: int, width: int) -> np.ndarray:
    """Colours that RGBE holds exactly, with runs and over many decades."""
    random = np.random.default_rng(4)
    colours = 10.0 ** random.uniform(-4.0, 5.0, (height, width, 3))
    colours[:, width // 3 : width // 2] = 0.25
    return decode_rgbe(encode_rgbe(colours))


def flat(
    pixels: np.ndarray, *lines: str, resolution: str | None = None
) -> bytes:
    """A flat file of ``pixels`` with further header lines."""
    height, width, _ = pixels.shape
    resolution = resolution or f"-Y {height} +X {width}"
    head = "\n".join(["#?RADIANCE", *lines, "", resolution, ""])
    return head.encode() + encode_rgbe(pixels).tobytes()


@pytest.mark.parametrize("coding", ["new", "old", "flat"])
@pytest.mark.parametrize("size", [(6, 12), (1, 1), (3, 7), (40, 80)])
def test_files_come_back(
    tmp_path: Path, coding: str, size: tuple[int, int]
) -> None:
    pixels = radiance(*size)
    write_radiance_hdr(tmp_path / "a.hdr", pixels, coding=coding)
    read = read_radiance_hdr(tmp_path / "a.hdr")
    assert read.dtype == np.float32
    assert read.flags.c_contiguous
    np.testing.assert_array_equal(read, pixels)


@pytest.mark.parametrize("y", "+-")
@pytest.mark.parametrize("x", "+-")
@pytest.mark.parametrize("columns_first", [False, True])
def test_every_orientation(y: str, x: str, columns_first: bool) -> None:
    pixels = radiance(3, 5)
    stored = pixels[:: 1 if y == "-" else -1, :: 1 if x == "+" else -1]
    resolution = f"{y}Y 3 {x}X 5"
    if columns_first:
        stored = stored.swapaxes(0, 1)
        resolution = f"{x}X 5 {y}Y 3"
    data = flat(stored, resolution=resolution)
    np.testing.assert_array_equal(parse_radiance_hdr(data, "a.hdr"), pixels)


def test_exposures_are_divided_out() -> None:
    pixels = radiance(2, 4)
    data = flat(
        pixels, "EXPOSURE=0.5", "EXPOSURE= 8.0", "COLORCORR=1.0 2.0 0.5"
    )
    np.testing.assert_allclose(
        parse_radiance_hdr(data, "a.hdr"), pixels / [4, 8, 2], rtol=1e-6
    )


def test_xyz_is_converted() -> None:
    # What the primaries and the white of Rec.709 are in XYZ.
    xyz = np.array(
        [
            [
                [0.4124, 0.2126, 0.0193],
                [0.3576, 0.7152, 0.1192],
                [0.1805, 0.0722, 0.9505],
                [0.9505, 1.0000, 1.0890],
            ]
        ]
    )
    data = flat(xyz, "FORMAT=32-bit_rle_xyze")
    expected = [[[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]]
    # RGBE keeps eight bits.
    np.testing.assert_allclose(
        parse_radiance_hdr(data, "a.hdr"), expected, atol=0.02
    )


def test_header_may_say_more() -> None:
    pixels = radiance(2, 4)
    data = flat(
        pixels,
        "# Made with EXPOSURE=3 something",
        "pcomb -e 'ro=1'",
        "GAMMA=1",
        "FORMAT=32-bit_rle_rgbe",
    )
    np.testing.assert_array_equal(parse_radiance_hdr(data, "a.hdr"), pixels)
    windows = data.replace(b"\n", b"\r\n", 7)
    np.testing.assert_array_equal(parse_radiance_hdr(windows, "a.hdr"), pixels)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "begin"),
        (b"\x89PNG\r\n", "begin"),
        (b"#?RADIANCE", "does not end"),
        (b"#?RADIANCE\n" + 70000 * b"a=1\n", "does not end"),
        (b"#?RADIANCE\n\n", "does not end"),
        (b"#?RADIANCE\n\n-Y 4 +X 8", "does not end"),
        (b"#?RADIANCE\n\n-Y 4\n", "resolution is '-Y 4'"),
        (b"#?RADIANCE\n\n-Y 4 +Y 8\n", "resolution"),
        (b"#?RADIANCE\n\n-Y 0 +X 8\n", "resolution"),
        (b"#?RADIANCE\n\n-Y 99999999 +X 99999999\n", "resolution"),
        (b"#?RADIANCE\nFORMAT=32-bit_exr\n\n-Y 4 +X 8\n", "format is"),
        (b"#?RADIANCE\nEXPOSURE=0\n\n-Y 4 +X 8\n", "EXPOSURE=0"),
        (b"#?RADIANCE\nEXPOSURE=bright\n\n-Y 4 +X 8\n", "bright"),
        (b"#?RADIANCE\nCOLORCORR=1\n\n-Y 4 +X 8\n", "COLORCORR"),
        (b"#?RADIANCE\n\n-Y 4 +X 8\n", "after 0 of 32 pixels"),
    ],
)
def test_broken_headers_are_named(data: bytes, reason: str) -> None:
    with pytest.raises(EnvironmentMapError, match=reason) as error:
        parse_radiance_hdr(data, "a.hdr")
    assert str(error.value).startswith("a.hdr: ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("coding", ["new", "old", "flat"])
def test_every_truncation_is_an_error(tmp_path: Path, coding: str) -> None:
    path = tmp_path / "a.hdr"
    write_radiance_hdr(path, radiance(8, 16), coding=coding)
    data = path.read_bytes()
    for size in range(len(data)):
        with pytest.raises(EnvironmentMapError):
            parse_radiance_hdr(data[:size], "a.hdr")


def test_unreadable_and_unwritable_paths(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "a.hdr"
    with pytest.raises(EnvironmentMapError, match=r"a\.hdr: .*No such file"):
        read_radiance_hdr(path)
    with pytest.raises(ImageFileError, match=r"a\.hdr: .*No such file"):
        write_radiance_hdr(path, radiance(2, 2))
    with pytest.raises(ValueError, match="'zip'"):
        write_radiance_hdr(tmp_path / "a.hdr", radiance(2, 2), coding="zip")


@pytest.mark.assets
@pytest.mark.parametrize(
    "name", ["spiaggia_di_mondello_1k.hdr", "f3d_default.hdr"]
)
def test_real_maps_come_back(assets: Path, tmp_path: Path, name: str) -> None:
    pixels = read_radiance_hdr(assets / "environments" / name)
    height, width, _ = pixels.shape
    assert width == 2 * height
    assert np.isfinite(pixels).all()
    assert pixels.max() > 1.0
    write_radiance_hdr(tmp_path / "a.hdr", pixels[::8])
    np.testing.assert_array_equal(
        read_radiance_hdr(tmp_path / "a.hdr"), pixels[::8]
    )
