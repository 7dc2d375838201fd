"""KTX2 files: what they decode to, and what is refused with words."""

import struct
import sys

import numpy as np
import pytest

from moka.core.decode import decode_image
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.image_header import media_type, pixel_size
from moka.core.ktx2 import open_ktx2
from tests.support.ktx2_files import FILES, KTX2_PICTURE, ktx2_file

WHERE = "model.glb: images[3]"


@pytest.mark.parametrize("name", FILES)
def test_the_picture_comes_back(name: str) -> None:
    image = EncodedImage(WHERE, data=ktx2_file(name))
    texels = decode_image(image)
    assert texels.shape == (8, 16, 4)
    expected = KTX2_PICTURE.astype(int)
    if "alpha" not in name:
        expected[:, :, 3] = 255
    # ETC1S has five bits a channel; UASTC keeps blocks of one colour.
    np.testing.assert_allclose(
        texels.astype(int), expected, atol=5 if "etc1s" in name else 0
    )


@pytest.mark.parametrize("name", FILES)
def test_the_header_is_read(name: str) -> None:
    data = ktx2_file(name)
    assert media_type(data) == "image/ktx2"
    assert pixel_size(EncodedImage(WHERE, data=data)) == (16, 8)
    texture = open_ktx2(data, WHERE)
    assert texture.size == (16, 8)
    assert texture.is_uastc == name.startswith("uastc")
    assert texture.has_alpha == ("alpha" in name)


def test_levels_are_those_of_the_file() -> None:
    texture = open_ktx2(ktx2_file("uastc alpha zstandard"), WHERE)
    assert texture.level_count == 5
    sizes = [texture.level("rgba8", level).shape[:2] for level in range(5)]
    assert sizes == [(8, 16), (4, 8), (2, 4), (1, 2), (1, 1)]
    smallest = texture.level("rgba8", 4)[0, 0].astype(int)
    np.testing.assert_allclose(smallest, KTX2_PICTURE.mean(axis=(0, 1)), atol=2)
    assert open_ktx2(ktx2_file("uastc"), WHERE).level_count == 1


@pytest.mark.parametrize(
    ("target", "block"),
    [("bc1", 8), ("bc3", 16), ("bc7", 16), ("etc1", 8), ("etc2", 16)],
)
def test_blocks_cover_the_picture(target: str, block: int) -> None:
    texture = open_ktx2(ktx2_file("etc1s"), WHERE)
    assert texture.level(target, 0).shape == (2, 4, block)
    assert texture.level(target, 4).shape == (1, 1, block)


def changed(data: bytes, offset: int, value: int, layout: str = "<I") -> bytes:
    result = bytearray(data)
    struct.pack_into(layout, result, offset, value)
    return bytes(result)


@pytest.mark.parametrize(
    ("offset", "value", "message"),
    [
        (12, 37, "has texels of vkFormat 37 and not of Basis Universal"),
        (20, 0, "has 0 x 8 pixels"),
        (24, 0, "has 16 x 0 pixels"),
        (28, 4, "is a volume 4 deep, not one picture"),
        (32, 3, "is an array of 3 layers, not one picture"),
        (36, 6, "is a cube map of 6 faces, not one picture"),
        (40, 6, "has 6 levels for 16 x 8 pixels"),
        (44, 3, "has supercompression 3, which its codec does not allow"),
        (48, 5000, "is cut off: its format lie beyond 553 bytes"),
        (56, 5000, "is cut off: its keys lie beyond 553 bytes"),
        (64, 5000, "is cut off: its tables lie beyond 553 bytes"),
        (80, 5000, "is cut off: level 0 ends beyond 553 bytes"),
    ],
)
def test_names_what_is_wrong(offset: int, value: int, message: str) -> None:
    data = changed(ktx2_file("etc1s"), offset, value)
    with pytest.raises(ImageFileError) as caught:
        open_ktx2(data, WHERE)
    assert str(caught.value).startswith(f"{WHERE}: the KTX2 image {message}")
    assert "\n" not in str(caught.value)


def test_huge_pictures_are_refused() -> None:
    data = changed(ktx2_file("etc1s"), 20, 0x20205F4B, "<I")
    with pytest.raises(ImageFileError, match="which are too many"):
        open_ktx2(data, WHERE)


def test_uastc_has_sixteen_bytes_for_every_block() -> None:
    data = changed(ktx2_file("uastc"), 20, 20)
    with pytest.raises(ImageFileError, match="has 128 bytes in level 0"):
        open_ktx2(data, WHERE)
    # What the decompressor would write is stated in the file too.
    data = changed(ktx2_file("uastc zstandard"), 96, 1 << 40, "<Q")
    with pytest.raises(ImageFileError, match=r"has 1099511627776 bytes"):
        open_ktx2(data, WHERE)


def test_other_codecs_are_refused() -> None:
    data = bytearray(ktx2_file("uastc"))
    (descriptor,) = struct.unpack_from("<I", data, 48)
    data[descriptor + 12] = 162  # plain ASTC
    with pytest.raises(ImageFileError, match="has colour model 162"):
        open_ktx2(bytes(data), WHERE)


def test_only_rows_that_run_down_are_allowed() -> None:
    data = ktx2_file("uastc")
    start = data.index(b"KTXwriter\0")
    for order in (b"ru", b"rd"):
        # In the place of another key, which is longer.
        key = b"KTXorientation\0" + order + b"\0"
        turned = data[:start] + key + data[start + len(key) :]
        if order == b"rd":
            assert open_ktx2(turned, WHERE).size == (16, 8)
            continue
        with pytest.raises(ImageFileError, match="orientation 'ru'"):
            open_ktx2(turned, WHERE)


@pytest.mark.parametrize("name", FILES)
def test_cut_files_are_errors(name: str) -> None:
    data = ktx2_file(name)
    for end in range(len(data)):
        image = EncodedImage(WHERE, data=data[:end])
        with pytest.raises(ImageFileError) as caught:
            decode_image(image)
        assert str(caught.value).startswith(f"{WHERE}: ")
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", FILES)
def test_broken_files_are_errors_and_nothing_worse(name: str) -> None:
    data = ktx2_file(name)
    random = np.random.default_rng(3)
    messages = []
    for _ in range(300):
        broken = bytearray(data)
        for place in random.integers(0, len(data), 2):
            broken[place] = random.integers(256)
        try:
            texture = open_ktx2(bytes(broken), WHERE)
            for level in range(texture.level_count):
                texture.level("rgba8", level)
        except ImageFileError as error:
            messages.append(str(error))
    assert messages
    assert not any("\n" in message for message in messages)


def test_the_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    with pytest.raises(ImageFileError) as caught:
        open_ktx2(ktx2_file("etc1s"), WHERE)
    assert str(caught.value) == (
        f"{WHERE}: needs the package opengl-basisu; "
        "pip install 'moka-pbr[compressed]'"
    )
