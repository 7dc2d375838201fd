"""PNG files as another reader sees them."""

import io
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as PillowImage

from moka.core import png
from moka.core.errors import ImageFileError
from moka.core.png import encode_png, write_png


def noise(*shape: int) -> np.ndarray:
    random = np.random.default_rng(3)
    return random.integers(0, 256, shape, dtype=np.uint8)


def decoded(data: bytes) -> np.ndarray:
    with PillowImage.open(io.BytesIO(data)) as image:
        image.load()
        return np.asarray(image)


@given(
    st.integers(1, 9), st.integers(1, 9), st.sampled_from([None, 1, 2, 3, 4])
)
def test_pixels_come_back(
    height: int, width: int, channels: int | None
) -> None:
    pixels = noise(height, width, *([channels] if channels else []))
    expected = pixels[:, :, 0] if channels == 1 else pixels
    np.testing.assert_array_equal(decoded(encode_png(pixels)), expected)


@pytest.mark.parametrize("height", [15, 16, 17, 127, 128, 129, 401])
@pytest.mark.parametrize("cores", [1, 2, 3, 8])
def test_bands_join_into_one_stream(
    monkeypatch: pytest.MonkeyPatch, height: int, cores: int
) -> None:
    monkeypatch.setattr(png.os, "cpu_count", lambda: cores)
    pixels = noise(height, 5, 3)
    pixels[height // 3 :] = 200
    np.testing.assert_array_equal(decoded(encode_png(pixels)), pixels)


def test_stream_ends_with_its_checksum() -> None:
    data = encode_png(noise(300, 40, 4))
    size = struct.unpack(">I", data[data.index(b"IDAT") - 4 :][:4])[0]
    start = data.index(b"IDAT") + 4
    # zlib itself refuses a wrong checksum.
    assert len(zlib.decompress(data[start : start + size])) == 300 * 161


def test_rows_may_lie_anywhere_in_memory() -> None:
    pixels = noise(70, 6, 4)[::-1, ::2]
    np.testing.assert_array_equal(decoded(encode_png(pixels)), pixels)


@pytest.mark.parametrize("channels", [2, 4])
def test_opaque_alpha_is_left_out(channels: int) -> None:
    pixels = noise(4, 4, channels)
    pixels[:, :, -1] = 255
    expected = pixels[:, :, :-1].squeeze()
    np.testing.assert_array_equal(decoded(encode_png(pixels)), expected)


def test_file_says_that_it_is_srgb() -> None:
    with PillowImage.open(io.BytesIO(encode_png(noise(2, 2, 3)))) as image:
        assert image.info["srgb"] == 0


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((2, 2, 3), np.float32),
        np.zeros((2, 2, 5), np.uint8),
        np.zeros((0, 2, 3), np.uint8),
    ],
)
def test_what_is_no_image_is_refused(pixels: np.ndarray) -> None:
    with pytest.raises(ValueError, match="image"):
        encode_png(pixels)


def test_written_to_a_path_or_a_file(tmp_path: Path) -> None:
    pixels = noise(3, 4, 3)
    stream = io.BytesIO()
    write_png(stream, pixels)
    write_png(tmp_path / "a.png", pixels)
    assert (tmp_path / "a.png").read_bytes() == stream.getvalue()


def test_error_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "missing" / "a.png"
    with pytest.raises(ImageFileError, match=r"a\.png: .*No such file"):
        write_png(path, noise(2, 2, 3))
