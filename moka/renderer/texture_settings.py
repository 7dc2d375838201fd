"""How textures are sampled and held, apart from what files say of them."""

import logging

from msgspec import Struct
from msgspec.structs import replace

from moka.commands.descriptors import Filter, MipmapMode
from moka.core.log import get_logger
from moka.material.material import Texture

__all__ = ["TextureSettings", "levels_beyond"]

_LOGGER = get_logger(__name__)


class TextureSettings(Struct, frozen=True):
    """Choices of :class:`moka.renderer.settings.RenderSettings`.

    ``anisotropy`` is the most samples along the longer side of a pixel's
    footprint, ``mip_filter`` whether two levels are mixed (``linear``) or
    the nearer one is read (``nearest``), ``max_size`` how many texels a side
    may have, None for what the driver takes. ``specular_aa`` keeps of normals
    what their levels average away.
    """

    anisotropy: int = 1
    max_size: int | None = None
    specular_aa: bool = False
    mip_filter: str = "linear"

    def sampled(self, texture: Texture) -> Texture:
        """The texture with the sampler that it is read with.

        Samplers that ask for the nearest texel, or for no mip levels, are
        meant to look so and stay as they are.
        """
        sampler = texture.sampler
        if sampler.mipmap is not MipmapMode.LINEAR or Filter.NEAREST in (
            sampler.minify,
            sampler.magnify,
        ):
            return texture
        chosen = replace(
            sampler,
            anisotropy=max(sampler.anisotropy, float(self.anisotropy)),
            mipmap=(
                MipmapMode.NEAREST
                if self.mip_filter == "nearest"
                else MipmapMode.LINEAR
            ),
        )
        if chosen == sampler:
            return texture
        return replace(texture, sampler=chosen)


def levels_beyond(
    size: tuple[int, int], most: int, wanted: int | None, where: str
) -> int:
    """How many levels of an image are larger than they may be.

    ``most`` is what the driver takes along a side, ``wanted`` what the user
    asked for; a line in the log tells where images are reduced.
    """
    limit = min(most, wanted or most)
    level = 0
    while max(size) >> level > limit:
        level += 1
    if level:
        _LOGGER.log(
            logging.INFO if limit == wanted else logging.WARNING,
            "%s: %d x %d texels are reduced to %d x %d; %s %d along a side",
            where,
            *size,
            *(max(1, side >> level) for side in size),
            "asked for are" if limit == wanted else "the driver takes",
            limit,
        )
    return level
