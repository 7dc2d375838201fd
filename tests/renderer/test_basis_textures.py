"""Which format a Basis Universal texture becomes, and with which levels."""

import pytest

from moka.backend.gl_info import compressed_formats
from moka.backend.protocol import BackendInfo
from moka.commands.descriptors import PixelFormat
from moka.core.encoded_image import EncodedImage
from moka.core.ktx2 import open_ktx2
from moka.renderer.basis_textures import choose_format, transcode
from moka.renderer.texture_request import TextureRequest
from tests.support.ktx2_files import ktx2_file

F = PixelFormat
ALL = frozenset(each for each in PixelFormat if each.block_bytes)
S3TC = "GL_EXT_texture_compression_s3tc"


@pytest.mark.parametrize(
    ("name", "formats", "expected"),
    [
        ("etc1s", ALL, F.BC7_SRGB),
        ("etc1s", {F.BC1_SRGB, F.BC3_SRGB}, F.BC1_SRGB),
        ("etc1s alpha", {F.BC1_SRGB, F.BC3_SRGB}, F.BC3_SRGB),
        ("etc1s", {F.ETC2_RGB_SRGB, F.ETC2_RGBA_SRGB}, F.ETC2_RGB_SRGB),
        ("etc1s alpha", {F.ETC2_RGB_SRGB}, F.SRGB8_ALPHA8),
        ("uastc", {F.ASTC_4X4_SRGB, F.BC1_SRGB}, F.ASTC_4X4_SRGB),
        ("uastc alpha zstandard", {F.BC1_SRGB}, F.SRGB8_ALPHA8),
        # A driver may lack the sRGB twin of a format.
        ("uastc", {F.BC7, F.BC1}, F.SRGB8_ALPHA8),
    ],
)
def test_the_best_format_of_the_driver_is_chosen(
    name: str, formats: frozenset[PixelFormat], expected: PixelFormat
) -> None:
    texture = open_ktx2(ktx2_file(name), "test")
    assert choose_format(texture, formats, is_colour=True)[0] is expected


def test_the_use_decides_the_encoding_and_not_the_file() -> None:
    # The file says sRGB.
    texture = open_ktx2(ktx2_file("etc1s"), "test")
    assert choose_format(texture, ALL, is_colour=False)[0] is F.BC7
    assert choose_format(texture, (), is_colour=False)[0] is F.RGBA8


@pytest.mark.parametrize("name", ["etc1s", "etc1s alpha", "uastc"])
def test_every_choice_can_be_transcoded(name: str) -> None:
    texture = open_ktx2(ktx2_file(name), "test")
    for pixels in ALL:
        chosen, target = choose_format(
            texture, {pixels}, is_colour="srgb" in pixels.value
        )
        blocks = texture.level(target, 0)
        assert blocks.shape[2] == (chosen.block_bytes or 4)


class Finest:
    """Stands for what a still picture samples."""

    def __init__(self, level: int) -> None:
        self.level = level

    def finest(self, _width: int, _height: int) -> int:
        return self.level


def image(name: str) -> EncodedImage:
    return EncodedImage("test", data=ktx2_file(name))


DRIVER = BackendInfo("test", compressed_formats=ALL)


def test_the_levels_of_the_file_are_taken() -> None:
    request = TextureRequest("", True, True)
    made = transcode(image("etc1s"), DRIVER, request, None)
    assert made is not None
    descriptor, levels = made
    assert (descriptor.width, descriptor.height) == (16, 8)
    assert descriptor.levels == len(levels) == 5
    for number, level in enumerate(levels):
        assert level.shape == descriptor.level_shape(number)


def test_levels_that_are_not_sampled_are_left_out() -> None:
    request = TextureRequest("", True, True)
    for wanted, size, count in ((2, (4, 2), 3), (9, (1, 1), 1)):
        made = transcode(
            image("etc1s"),
            DRIVER,
            request,
            Finest(wanted),  # type: ignore[arg-type]
        )
        assert made is not None
        descriptor, levels = made
        assert (descriptor.width, descriptor.height) == size
        assert descriptor.levels == len(levels) == count
    request = TextureRequest("", True, has_levels=False)
    made = transcode(image("etc1s"), DRIVER, request, None)
    assert made is not None
    assert made[0].levels == 1


def test_a_file_without_levels_leaves_them_to_others() -> None:
    request = TextureRequest("", True, True)
    assert transcode(image("uastc"), DRIVER, request, None) is None
    request = TextureRequest("", True, has_levels=False)
    assert transcode(image("uastc"), DRIVER, request, None) is not None


def test_no_blocks_for_drivers_in_software() -> None:
    extensions = {S3TC, "GL_ARB_texture_compression_bptc"}
    for renderer in ("llvmpipe (LLVM 15.0.6, 256 bits)", "SwiftShader Device"):
        assert not compressed_formats(renderer, 450, extensions)
    assert F.BC7_SRGB in compressed_formats("Some GPU", 330, extensions)


def test_formats_come_with_versions_or_extensions() -> None:
    assert not compressed_formats("Some GPU", 330, set())
    assert compressed_formats("Some GPU", 420, set()) == {F.BC7, F.BC7_SRGB}
    assert compressed_formats("Some GPU", 330, {S3TC}) == {F.BC1, F.BC3}
    with_srgb = compressed_formats(
        "Some GPU", 330, {S3TC, "GL_EXT_texture_sRGB"}
    )
    assert with_srgb == {F.BC1, F.BC3, F.BC1_SRGB, F.BC3_SRGB}
    etc = compressed_formats("Some GPU", 430, set())
    assert F.ETC2_RGBA_SRGB in etc
