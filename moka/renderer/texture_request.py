"""Which image a texture is made of, and how the GPU is to hold it."""

from typing import Any

from msgspec import Struct

from moka.commands.descriptors import MipmapMode
from moka.material.material import Texture

__all__ = [
    "Bumps",
    "Coverage",
    "Graft",
    "TextureRequest",
    "texture_request",
]

_COLOUR_SLOTS = frozenset({"base_colour", "emissive", "specular_colour"})


class Graft(Struct, frozen=True):
    """That channel ``into`` of a texture is channel ``of`` another image.

    ``identity`` is the image's, which has the same size.
    """

    identity: str
    of: int
    into: int


class Coverage(Struct, frozen=True):
    """That the alpha of a texture is how much of the surface is there.

    With ``cutoff`` it is there where alpha reaches it.
    """

    cutoff: float | None = None


class Bumps(Struct, frozen=True):
    """That levels of normals keep in their alpha what they average.

    ``scale`` is the normals' scale, for ``roughness_factor`` see
    :func:`moka.core.normal_levels.normal_filter`.
    """

    scale: float
    roughness_factor: float | None


class TextureRequest(Struct, frozen=True):
    """An image and how the GPU is to hold it.

    Without ``coverage`` the alpha is not part of a colour. ``max_size`` is
    the most texels along a side, ``picture`` the number of the still picture
    that it is for, 0 for any.
    """

    identity: str
    is_colour: bool
    has_levels: bool
    graft: Graft | None = None
    coverage: Coverage | None = None
    bumps: Bumps | None = None
    max_size: int | None = None
    picture: int = 0


def texture_request(
    slot: str, texture: Texture, **choices: Any
) -> TextureRequest:
    """The request for a texture of a material; ``choices`` are its fields."""
    return TextureRequest(
        texture.image.identity,
        slot in _COLOUR_SLOTS,
        texture.sampler.mipmap is not MipmapMode.NONE,
        **choices,
    )
