"""Samplers as settings make them, and as files mean them."""

import pytest

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Wrap,
)
from moka.core.encoded_image import EncodedImage
from moka.core.errors import OptionError
from moka.material.material import Texture
from moka.renderer.settings import RenderSettings

IMAGE = EncodedImage("model.gltf: images[0]", data=b"one")
SMOOTH = SamplerDescriptor(Wrap.CLAMP_TO_EDGE)


def sampled(sampler: SamplerDescriptor, **settings: object) -> Texture:
    """A texture as these settings read it."""
    textures = RenderSettings(**settings).textures  # type: ignore[arg-type]
    return textures.sampled(Texture(IMAGE, sampler))


def test_the_nearest_level_is_read_where_two_would_be_mixed() -> None:
    texture = sampled(SMOOTH, mip_filter="nearest", anisotropy=4)
    assert texture.sampler.mipmap is MipmapMode.NEAREST
    assert texture.sampler.anisotropy == 4
    assert texture.sampler.wrap_s is Wrap.CLAMP_TO_EDGE
    assert sampled(SMOOTH) == Texture(IMAGE, SMOOTH)


@pytest.mark.parametrize(
    "sampler",
    [
        SamplerDescriptor(magnify=Filter.NEAREST),
        SamplerDescriptor(minify=Filter.NEAREST),
        SamplerDescriptor(mipmap=MipmapMode.NONE),
        SamplerDescriptor(mipmap=MipmapMode.NEAREST),
    ],
)
def test_what_is_meant_to_look_so_stays(sampler: SamplerDescriptor) -> None:
    texture = sampled(sampler, mip_filter="nearest", anisotropy=16)
    assert texture.sampler == sampler


def test_an_unknown_filter_is_refused() -> None:
    with pytest.raises(OptionError, match="mip filter: 'cubic' is unknown"):
        RenderSettings(mip_filter="cubic")
