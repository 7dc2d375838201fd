"""The fast JPEG decoder gives what Pillow gives, or leaves it to Pillow."""

import io
import sys

import numpy as np
import pytest
from PIL import Image as PillowImage

from moka.core.decode import decode_image, with_alpha
from moka.core.encoded_image import EncodedImage
from moka.core.jpeg import decode_common_jpeg

MANY = 1 << 20


def smooth(mode: str = "RGB") -> PillowImage.Image:
    ramp = np.linspace(0, 255, 45).astype(np.uint8)
    planes = [ramp + 0 * ramp[:31, None], ramp[:31, None] + 0 * ramp]
    texels = np.dstack([*planes, planes[0][::-1]])
    return PillowImage.fromarray(texels).convert(mode)


def encode(image: PillowImage.Image, **options: object) -> bytes:
    stream = io.BytesIO()
    image.save(stream, "JPEG", **options)
    return stream.getvalue()


@pytest.mark.parametrize("progressive", [False, True])
@pytest.mark.parametrize("subsampling", [0, 1, 2])
@pytest.mark.parametrize("restart", [0, 2])
def test_colours_are_those_of_pillow(
    subsampling: int, progressive: bool, restart: int
) -> None:
    data = encode(
        smooth(),
        subsampling=subsampling,
        progressive=progressive,
        restart_marker_blocks=restart,
    )
    texels = decode_common_jpeg(data, MANY)
    assert texels is not None
    with PillowImage.open(io.BytesIO(data)) as file:
        np.testing.assert_array_equal(texels, np.asarray(file))
    padded = with_alpha(texels)
    assert padded is texels.base
    np.testing.assert_array_equal(padded[:, :, :3], texels)
    assert (padded[:, :, 3] == 255).all()


def test_grey_has_one_channel() -> None:
    data = encode(smooth("L"))
    texels = decode_common_jpeg(memoryview(data), MANY)
    assert texels is not None
    with PillowImage.open(io.BytesIO(data)) as file:
        np.testing.assert_array_equal(texels[:, :, 0], np.asarray(file))


@pytest.mark.parametrize(
    "data",
    [
        encode(smooth("CMYK")),
        encode(smooth(), keep_rgb=True),
        encode(smooth())[:-30],
        b"\xff\xd8\xff",
    ],
    ids=["CMYK", "RGB", "truncated", "broken"],
)
def test_what_is_unusual_is_left_to_others(data: bytes) -> None:
    assert decode_common_jpeg(data, MANY) is None


def test_many_pixels_are_left_to_others() -> None:
    data = encode(smooth())
    assert decode_common_jpeg(data, 45 * 31 - 1) is None
    assert decode_common_jpeg(data, 45 * 31) is not None


def test_what_pillow_bears_with_is_decoded() -> None:
    """Bytes of nothing before a marker are a fault that can be mended."""
    data = encode(smooth())
    padded = data[:-2] + b"\0" * 9 + data[-2:]
    assert decode_common_jpeg(padded, MANY) is None
    images = [
        decode_image(EncodedImage("a.jpg", data=each))
        for each in (data, padded)
    ]
    np.testing.assert_array_equal(*images)


def test_pillow_is_not_loaded_for_a_common_file(tmp_path) -> None:
    import subprocess

    path = tmp_path / "a.jpg"
    path.write_bytes(encode(smooth()))
    check = (
        "import sys; from pathlib import Path\n"
        "from moka.core.decode import decode_image\n"
        "from moka.core.encoded_image import EncodedImage\n"
        f"decode_image(EncodedImage('a', path=Path({str(path)!r})))\n"
        "sys.exit('PIL' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", check], check=True)
