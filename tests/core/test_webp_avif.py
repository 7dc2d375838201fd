"""WebP and AVIF: texels, sizes from headers, broken files."""

import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

from moka.core.decode import decode_image
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.image_header import media_type, pixel_size

Texels = np.ndarray[Any, Any]


def picture(channels: int, width: int = 37, height: int = 23) -> Texels:
    """Smooth enough for a lossy codec, different in every channel."""
    y, x = np.mgrid[0:height, 0:width]
    waves = [x * 6, y * 10, 255 - x * 3 - y * 3, 128 + x + y]
    return np.stack(waves[:channels], axis=-1).astype(np.uint8)


def encode(texels: Texels, kind: str, **options: Any) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(texels).save(buffer, kind, **options)
    return buffer.getvalue()


def decode(data: bytes) -> Texels:
    return decode_image(EncodedImage("file: images[0]", data=data))


@pytest.mark.parametrize("channels", [3, 4])
def test_lossless_webp_comes_back_as_it_was(channels: int) -> None:
    texels = picture(channels)
    data = encode(texels, "WEBP", lossless=True, exact=True)
    np.testing.assert_array_equal(decode(data), texels)


@pytest.mark.parametrize("channels", [3, 4])
def test_avif_comes_back_closely(channels: int) -> None:
    texels = picture(channels)
    data = encode(texels, "AVIF", quality=100, subsampling="4:4:4")
    np.testing.assert_allclose(
        decode(data).astype(int), texels.astype(int), atol=4
    )


@pytest.mark.parametrize(
    ("kind", "options", "channels"),
    [
        ("WEBP", {"lossless": True}, 3),
        ("WEBP", {"quality": 80}, 3),
        ("WEBP", {"quality": 80}, 4),  # an extended header
        ("AVIF", {"quality": 60}, 3),
        ("AVIF", {"quality": 60}, 4),  # a second item for alpha
    ],
)
def test_the_size_stands_in_the_header(
    kind: str, options: dict[str, Any], channels: int
) -> None:
    data = encode(picture(channels), kind, **options)
    assert media_type(data) == f"image/{kind.lower()}"
    image = EncodedImage("image", data=data)
    assert pixel_size(image) == (37, 23)
    # Cut anywhere, a header has no size or the right one.
    for end in range(min(len(data), 400)):
        size = pixel_size(EncodedImage("image", data=data[:end]))
        assert size in (None, (37, 23))


def test_an_avif_is_turned_as_it_says() -> None:
    texels = picture(3)
    exif = Image.Exif()
    exif[0x0112] = 6
    turned = encode(texels, "AVIF", quality=100, subsampling="4:4:4", exif=exif)
    np.testing.assert_allclose(
        decode(turned).astype(int), np.rot90(texels, -1).astype(int), atol=4
    )


@pytest.mark.parametrize("kind", ["WEBP", "AVIF"])
def test_broken_files_are_one_line(kind: str) -> None:
    data = encode(picture(3), kind)
    for end in range(40, len(data), 7):
        with pytest.raises(ImageFileError) as caught:
            decode(data[:end])
        message = str(caught.value)
        assert message.startswith("file: images[0]: cannot decode the image")
        assert "\n" not in message


def test_a_huge_webp_is_refused_before_it_is_decoded() -> None:
    data = bytearray(encode(picture(4), "WEBP", quality=80))
    assert data[12:16] == b"VP8X"
    data[24:30] = b"\xfe\x3f\x00\xfe\x3f\x00"
    with pytest.raises(ImageFileError):
        decode(bytes(data))
