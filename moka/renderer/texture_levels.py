"""From the texels of images to the levels of a texture, in any thread."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import PixelFormat
from moka.core.shared_work import Run
from moka.renderer.texture_request import Graft, TextureRequest

if TYPE_CHECKING:
    from moka.core.mip_levels import Finish

__all__ = ["arrange_texels", "is_of_one_colour", "make_levels"]

_DATA_FORMATS = {
    ("u1", 1): PixelFormat.R8,
    ("u1", 2): PixelFormat.RG8,
    ("u1", 3): PixelFormat.RGB8,
    ("u1", 4): PixelFormat.RGBA8,
    ("u2", 1): PixelFormat.R16,
    ("u2", 2): PixelFormat.RG16,
    ("u2", 3): PixelFormat.RGB16,
    ("u2", 4): PixelFormat.RGBA16,
}
_COLOUR_FORMATS = {3: PixelFormat.SRGB8, 4: PixelFormat.SRGB8_ALPHA8}

# Drivers hold three bytes as four anyway. Given as four, a 2048x2048 texture
# uploads in a quarter of the time here and its colours sample in two thirds.
_PADDED = {
    PixelFormat.SRGB8: PixelFormat.SRGB8_ALPHA8,
    PixelFormat.RGB8: PixelFormat.RGBA8,
}


def arrange_texels(
    request: TextureRequest, images: Sequence[NDArray[Any]], *, spare: bool
) -> tuple[NDArray[Any], PixelFormat, bool]:
    """The texels (H, W, C) of a texture, their format, and whether opaque.

    ``images`` are the texels of those that the request names, the first of
    which may be changed if it is ``spare``. Opaque is what has a fourth
    channel only because drivers hold four.
    """
    from moka.core.decode import with_alpha

    texels, *others = images
    texels = _arrange(texels, is_colour=request.is_colour)
    alone = request.bumps is not None and request.graft is None
    if alone and texels.shape[2] == 4:
        # What the file has in an alpha of normals means nothing.
        texels = np.ascontiguousarray(texels[:, :, :3])
    if request.graft is not None:
        texels = _grafted(texels, others[0], request.graft, spare=spare)
    pixels = (
        _COLOUR_FORMATS[texels.shape[2]]
        if request.is_colour
        else _DATA_FORMATS[texels.dtype.str[1:], texels.shape[2]]
    )
    if pixels in _PADDED:
        return with_alpha(texels), _PADDED[pixels], True
    if request.bumps is not None and texels.shape[2] == 3:
        white = np.full_like(texels[:, :, :1], np.iinfo(texels.dtype).max)
        texels = np.concatenate([texels, white], axis=2)
        pixels = PixelFormat.RGBA16
    return texels, pixels, False


def make_levels(
    request: TextureRequest,
    texels: NDArray[Any],
    *,
    opaque: bool,
    finest: int,
    run: Run,
) -> list[NDArray[Any]]:
    """The levels of arranged texels from ``finest`` on; one if asked for so.

    ``run`` does blocks of them.
    """
    from moka.core.mip_levels import reduce_levels

    if not request.has_levels and not finest:
        return [texels]
    if request.coverage is not None and not opaque:
        from moka.core.alpha_levels import reduce_alpha_levels

        levels = reduce_alpha_levels(
            texels, cutoff=request.coverage.cutoff, finest=finest
        )
    else:
        # What nobody reads may be white: alpha that is no coverage of
        # colours that carry nothing.
        levels = reduce_levels(
            texels,
            srgb=request.is_colour,
            opaque=opaque or (request.is_colour and not request.graft),
            finish=_finish(request, texels),
            finest=finest,
            run=run,
        )
    return levels if request.has_levels else levels[:1]


def is_of_one_colour(texels: NDArray[Any]) -> bool:
    """Whether all texels are the same; most images show it at a glance."""
    first = texels[0, 0]
    if (texels[::61, ::61] != first).any():
        return False
    return all(bool((row == first).all()) for row in texels)


def _finish(request: TextureRequest, texels: NDArray[Any]) -> "Finish | None":
    if request.bumps is None:
        return None
    from moka.core.normal_levels import normal_filter

    return normal_filter(
        texels,
        scale=request.bumps.scale,
        roughness_factor=request.bumps.roughness_factor,
    )


def _grafted(
    texels: NDArray[Any], other: NDArray[Any], graft: Graft, *, spare: bool
) -> NDArray[Any]:
    """Texels of which one channel is that of another image of their size.

    ``spare`` ones may be changed.
    """
    from moka.core.decode import with_alpha

    # In grey images red, green and blue are one.
    channel = other[:, :, graft.of if other.shape[2] > 2 else 0]
    kind = max(texels.dtype, other.dtype)
    channels = max(texels.shape[2], graft.into + 1)
    if texels.shape[2] == 3 and texels.dtype == np.uint8:
        texels = with_alpha(texels)
    stored = max(texels.shape[2], channels)
    fits = texels.dtype == kind and texels.shape[2] == stored
    if spare and fits and texels.flags.writeable:
        joined = texels
    else:
        joined = np.empty((*texels.shape[:2], stored), kind)
        joined[:, :, : texels.shape[2]] = _widened(texels, kind)
    joined[:, :, graft.into] = _widened(channel, kind)
    # Without what is only padding, which is found again.
    return joined[:, :, :channels]


def _widened(texels: NDArray[Any], kind: np.dtype[Any]) -> NDArray[Any]:
    """Codes as codes of a type that may be wider: 255 becomes 65 535."""
    if texels.dtype == kind:
        return texels
    wide: NDArray[Any] = texels.astype(kind) * kind.type(257)
    return wide


def _arrange(texels: NDArray[Any], *, is_colour: bool) -> NDArray[Any]:
    """Texels that a format on the GPU holds with the least loss.

    Grey images become RGB where a shader reads colours: GL's sRGB formats
    have three or four channels, and data are read as r, g, b.
    """
    channels = texels.shape[2]
    if channels <= 2:
        grey = np.repeat(texels[:, :, :1], 3, axis=2)
        texels = (
            np.concatenate([grey, texels[:, :, 1:]], axis=2)
            if channels == 2
            else grey
        )
    if is_colour and texels.dtype == np.uint16:
        # There is no 16-bit sRGB format.
        texels = ((texels.astype(np.uint32) + 128) // 257).astype(np.uint8)
    return texels
