"""Texels of every kind of PNG and JPEG, and of what is broken."""

import io
import struct
import subprocess
import sys
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage
from PIL import ImageOps

from moka.core.decode import decode_image
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError

WHERE = "model.gltf: images[3]"


def noise(*shape: int, dtype: type = np.uint8) -> np.ndarray:
    random = np.random.default_rng(11)
    return random.integers(0, np.iinfo(dtype).max + 1, shape, dtype=dtype)


def encode(image: PillowImage.Image, kind: str = "PNG", **options) -> bytes:
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


def png(texels: np.ndarray, colour_type: int, *chunks: bytes) -> bytes:
    """A PNG of unfiltered rows, for what Pillow cannot write."""
    height, width = texels.shape[:2]
    rows = texels.astype(texels.dtype.newbyteorder(">")).reshape(height, -1)
    data = b"".join(b"\0" + row.tobytes() for row in rows)
    depth = 8 * texels.dtype.itemsize
    header = struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, 0)
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", header),
            *chunks,
            chunk(b"IDAT", zlib.compress(data)),
            chunk(b"IEND", b""),
        ]
    )


def chunk(name: bytes, data: bytes) -> bytes:
    size = struct.pack(">I", len(data))
    return size + name + data + struct.pack(">I", zlib.crc32(name + data))


def decoded(data: bytes) -> np.ndarray:
    return decode_image(EncodedImage(WHERE, data=data))


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_eight_bit_png(channels: int) -> None:
    texels = noise(5, 7, channels)
    data = encode(PillowImage.fromarray(texels.squeeze()))
    np.testing.assert_array_equal(decoded(data), texels)


@pytest.mark.parametrize(("channels", "colour_type"), [(1, 0), (3, 2), (4, 6)])
def test_sixteen_bit_png_keeps_its_bits(
    channels: int, colour_type: int
) -> None:
    texels = noise(5, 7, channels, dtype=np.uint16)
    result = decoded(png(texels, colour_type))
    assert result.dtype == np.uint16
    np.testing.assert_array_equal(result, texels)


def test_sixteen_bit_grey_and_alpha_becomes_eight_bit_rgba() -> None:
    texels = noise(5, 7, 2, dtype=np.uint16)
    result = decoded(png(texels, 4))
    assert result.dtype == np.uint8
    np.testing.assert_array_equal(result, (texels >> 8)[:, :, [0, 0, 0, 1]])


def test_one_bit_png_is_black_and_white() -> None:
    texels = noise(5, 9) > 127
    result = decoded(encode(PillowImage.fromarray(texels)))
    np.testing.assert_array_equal(result[:, :, 0], 255 * texels)


@pytest.mark.parametrize("transparent", [False, True])
def test_palette_becomes_colours(transparent: bool) -> None:
    codes = noise(5, 7) % 3
    colours = noise(3, 3)
    image = PillowImage.fromarray(codes, "P")
    image.putpalette(colours.tobytes())
    if not transparent:
        np.testing.assert_array_equal(decoded(encode(image)), colours[codes])
        return
    alpha = np.array([255, 0, 128], np.uint8)
    result = decoded(encode(image, transparency=alpha.tobytes()))
    expected = np.column_stack([colours, alpha])[codes]
    np.testing.assert_array_equal(result, expected)


def test_colour_key_becomes_alpha() -> None:
    texels = noise(4, 4, 3)
    key = struct.pack(">HHH", *texels[1, 2])
    result = decoded(png(texels, 2, chunk(b"tRNS", key)))
    assert result.shape == (4, 4, 4)
    assert result[1, 2, 3] == 0
    assert (result[:, :, 3] == 0).sum() == 1
    grey = noise(4, 4)
    key = struct.pack(">H", grey[0, 0])
    result = decoded(png(grey, 0, chunk(b"tRNS", key)))
    np.testing.assert_array_equal(
        result, np.dstack([grey, 255 * (grey != grey[0, 0])])
    )


def test_interlaced_png() -> None:
    """Adam7: ISO/IEC 15948, 8.2; seven pictures of fewer pixels."""
    texels = noise(11, 13, 3)
    rows = b""
    for x, y, dx, dy in (
        (0, 0, 8, 8),
        (4, 0, 8, 8),
        (0, 4, 4, 8),
        (2, 0, 4, 4),
        (0, 2, 2, 4),
        (1, 0, 2, 2),
        (0, 1, 1, 2),
    ):
        rows += b"".join(b"\0" + r.tobytes() for r in texels[y::dy, x::dx])
    header = struct.pack(">IIBBBBB", 13, 11, 8, 2, 0, 0, 1)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
    data += chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    np.testing.assert_array_equal(decoded(data), texels)


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_profiles_are_ignored(kind: str) -> None:
    """glTF 2.0, 3.8.2: texels are what they are, whatever is said of them."""
    from PIL import ImageCms

    image = PillowImage.fromarray(noise(16, 16, 3))
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB"))
    tagged = encode(image, kind, icc_profile=profile.tobytes())
    assert len(tagged) > len(encode(image, kind))
    np.testing.assert_array_equal(decoded(tagged), decoded(encode(image, kind)))


def test_gamma_is_ignored() -> None:
    texels = noise(4, 4, 3)
    gamma = chunk(b"gAMA", struct.pack(">I", 100000))
    np.testing.assert_array_equal(decoded(png(texels, 2, gamma)), texels)


def test_adobe_ycck_jpeg_is_not_inverted() -> None:
    """As browsers show it: white paper is white."""
    cmyk = np.zeros((32, 32, 4), np.uint8)
    cmyk[8:24, 8:24] = (0, 255, 255, 0)
    data = encode(PillowImage.fromarray(cmyk, "CMYK"), "JPEG", quality=95)
    assert b"Adobe" in data
    result = decoded(data).astype(int)
    assert np.abs(result[2, 2] - 255).max() < 6
    assert np.abs(result[16, 16] - (255, 0, 0)).max() < 24


@pytest.mark.parametrize("mode", ["L", "RGB", "CMYK"])
@pytest.mark.parametrize("progressive", [False, True])
def test_jpeg(mode: str, progressive: bool) -> None:
    ramp = np.linspace(0, 255, 32).astype(np.uint8)
    image = PillowImage.fromarray(np.dstack([ramp + 0 * ramp[:, None]] * 3))
    data = encode(
        image.convert(mode), "JPEG", quality=95, progressive=progressive
    )
    result = decoded(data)
    assert result.shape == (32, 32, 1 if mode == "L" else 3)
    assert np.abs(result.astype(int) - ramp[:, None]).max() < 8


@pytest.mark.parametrize("kind", ["JPEG", "PNG"])
@pytest.mark.parametrize("orientation", range(10))
def test_orientation_is_applied_as_elsewhere(
    kind: str, orientation: int
) -> None:
    image = PillowImage.fromarray(noise(8, 16, 3))
    exif = PillowImage.Exif()
    exif[0x010F] = "maker"
    exif[0x0112] = orientation
    data = encode(image, kind, exif=exif)
    with PillowImage.open(io.BytesIO(data)) as file:
        expected = np.asarray(ImageOps.exif_transpose(file))
    result = decoded(data)
    np.testing.assert_array_equal(result, expected)


def test_broken_exif_is_ignored() -> None:
    image = PillowImage.fromarray(noise(2, 3))
    for exif in (b"Exif\0\0II*\0", b"Exif\0\0MM\0*\xff\xff\xff\xff", b"Exif"):
        # Without a resolution Pillow would look for one in the EXIF data.
        data = encode(image, "JPEG", exif=exif, dpi=(72, 72))
        assert decoded(data).shape == (2, 3, 1)


@pytest.mark.parametrize("kind", ["JPEG", "PNG"])
def test_every_truncation_names_the_image(kind: str) -> None:
    data = encode(PillowImage.fromarray(noise(40, 40, 3)), kind)
    for size in [*range(0, 200, 9), *range(200, len(data) - 30, 331)]:
        with pytest.raises(ImageFileError) as error:
            decoded(data[:size])
        assert str(error.value).startswith(WHERE)
        assert "\n" not in str(error.value)


def test_other_formats_are_named_as_such() -> None:
    data = encode(PillowImage.fromarray(noise(2, 2, 3)), "BMP")
    with pytest.raises(ImageFileError, match="neither PNG, JPEG, WebP"):
        decoded(data)


def test_bomb_is_an_error_before_it_goes_off() -> None:
    data = bytearray(encode(PillowImage.fromarray(noise(2, 2))))
    start = data.index(b"IHDR")
    data[start + 4 : start + 12] = struct.pack(">II", 60000, 60000)
    header = bytes(data[start : start + 17])
    data[start + 17 : start + 21] = struct.pack(">I", zlib.crc32(header))
    with pytest.raises(ImageFileError, match=r"60000 x 60000 .* too many"):
        decoded(bytes(data))


def test_large_image_is_no_reason_for_a_warning() -> None:
    # Beyond the size at which Pillow warns; an error is the next row down.
    data = bytearray(encode(PillowImage.fromarray(noise(2, 2))))
    start = data.index(b"IHDR")
    data[start + 4 : start + 12] = struct.pack(">II", 10000, 10000)
    header = bytes(data[start : start + 17])
    data[start + 17 : start + 21] = struct.pack(">I", zlib.crc32(header))
    with pytest.raises(ImageFileError, match=r"truncated|broken|ends|stream"):
        decoded(bytes(data))


def test_missing_file_names_the_image(tmp_path: Path) -> None:
    image = EncodedImage(WHERE, path=tmp_path / "missing.png")
    with pytest.raises(ImageFileError, match=r"images\[3\].*missing\.png"):
        decode_image(image)


def test_threads_decode_at_once() -> None:
    texels = [noise(64, 64, 3) // (k + 1) for k in range(8)]
    data = [encode(PillowImage.fromarray(t)) for t in texels]
    with ThreadPoolExecutor(4) as pool:
        for result, expected in zip(
            pool.map(decoded, data), texels, strict=True
        ):
            np.testing.assert_array_equal(result, expected)


def test_import_takes_no_image_library_along() -> None:
    check = "import sys, moka.core.decode; sys.exit('PIL' in sys.modules)"
    subprocess.run([sys.executable, "-c", check], check=True)


@pytest.mark.assets
def test_real_textures(assets: Path) -> None:
    paths = (assets / "models" / "DamagedHelmet").glob("*.jpg")
    for path in [*paths, assets / "models/ClearCoatTest/RibsNormal.png"]:
        result = decode_image(EncodedImage(path.name, path=path))
        with PillowImage.open(path) as file:
            np.testing.assert_array_equal(result.squeeze(), np.asarray(file))
