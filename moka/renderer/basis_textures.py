"""Basis Universal textures in the format that suits the driver.

Blocks stay blocks where the GPU samples them: a quarter or an eighth of the
memory of texels, with the levels that the author's tool made. Elsewhere, and
on drivers in software, they become texels of four bytes.
"""

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from moka.backend.protocol import BackendInfo
from moka.commands.descriptors import PixelFormat, TextureDescriptor
from moka.core.encoded_image import EncodedImage
from moka.core.ktx2 import Ktx2Texture, open_ktx2
from moka.renderer.texture_settings import levels_beyond

if TYPE_CHECKING:
    from moka.renderer.sampled_levels import SampledLevels
    from moka.renderer.texture_request import TextureRequest

__all__ = ["choose_format", "transcode"]

# What to transcode to, best first: the pixel format without its encoding,
# and the transcoder's name of it. BC7 loses least of either codec. UASTC is
# a subset of ASTC, and ETC1S one of ETC1, whose blocks are ETC2's too;
# without alpha a block takes half.
_BC7, _ASTC = ("bc7", "bc7"), ("astc_4x4", "astc_4x4")
_PREFERENCES = {
    # by whether it is UASTC and whether it has alpha
    (True, True): (_BC7, _ASTC, ("bc3", "bc3"), ("etc2_rgba", "etc2")),
    (True, False): (_BC7, _ASTC, ("bc1", "bc1"), ("etc2_rgb", "etc1")),
    (False, True): (_BC7, ("bc3", "bc3"), ("etc2_rgba", "etc2"), _ASTC),
    (False, False): (_BC7, ("bc1", "bc1"), ("etc2_rgb", "etc1"), _ASTC),
}


def choose_format(
    texture: Ktx2Texture, formats: Collection[PixelFormat], *, is_colour: bool
) -> tuple[PixelFormat, str]:
    """The pixel format for ``texture``, and the transcoder's name of it.

    ``formats`` are those of blocks that the driver samples. ``is_colour``
    says whether texels are sRGB-encoded; how the texture is used decides it
    and not what its file says.
    """
    suffix = "_srgb" if is_colour else ""
    for name, target in _PREFERENCES[texture.is_uastc, texture.has_alpha]:
        pixels = PixelFormat(name + suffix)
        if pixels in formats:
            return pixels, target
    plain = PixelFormat.SRGB8_ALPHA8 if is_colour else PixelFormat.RGBA8
    return plain, "rgba8"


def transcode(
    image: EncodedImage,
    info: BackendInfo,
    request: "TextureRequest",
    read: "SampledLevels | None",
) -> tuple[TextureDescriptor, list[NDArray[Any]]] | None:
    """A texture with the levels of its file, as far as they are sampled.

    None if levels are needed that the file does not have: then they are to
    be made as those of any image. Raises ImageFileError.
    """
    texture = open_ktx2(image.read(), image.where)
    count = 1
    first = levels_beyond(
        texture.size, info.max_texture_size, request.max_size, image.where
    )
    if request.has_levels:
        count = texture.level_count
        if count == 1 < max(texture.size).bit_length():
            return None
        if read is not None:
            first = max(first, min(read.finest(*texture.size), count - 1))
    if first >= count:
        return None
    pixels, target = choose_format(
        texture, info.compressed_formats, is_colour=request.is_colour
    )
    width, height = (max(1, side >> first) for side in texture.size)
    levels = [texture.level(target, level) for level in range(first, count)]
    return (
        TextureDescriptor(
            pixels, width, height, levels=len(levels), label=image.where
        ),
        levels,
    )
