"""Decodes the images that visible materials sample, in worker threads.

The same image used as colour and as data is decoded once and uploaded for
each. Workers reduce the mip levels too, in linear light for colours, so that
the render thread only copies.
"""

import os
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import (
    MipmapMode,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.core.encoded_image import EncodedImage
from moka.core.image_header import image_media_type
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.material.material import Texture
from moka.renderer.sampled_levels import SampledLevels
from moka.renderer.texture_settings import levels_beyond

if TYPE_CHECKING:
    from moka.core.mip_levels import Finish

__all__ = [
    "Bumps",
    "Coverage",
    "Graft",
    "TexturePool",
    "TextureRequest",
    "texture_request",
]

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

COLOUR_SLOTS = frozenset({"base_colour", "emissive"})


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
        slot in COLOUR_SLOTS,
        texture.sampler.mipmap is not MipmapMode.NONE,
        **choices,
    )


class TexturePool:
    """The textures of one device, by image content and use."""

    def __init__(self, device: GraphicsDevice, statistics: Statistics) -> None:
        self._device = device
        self._statistics = statistics
        # The main thread and the render thread work beside them.
        self._workers = ThreadPoolExecutor(
            max_workers=max(2, os.cpu_count() or 1),
            thread_name_prefix="moka-decode",
        )
        self._pending: dict[TextureRequest, Future[Handle]] = {}

    def begin(
        self,
        wanted: Mapping[TextureRequest, Sequence[EncodedImage]],
        levels: Mapping[TextureRequest, SampledLevels] | None = None,
    ) -> None:
        """Begin to decode textures; :meth:`handle` waits for one.

        ``wanted`` has the images that each request names. ``levels`` tells
        which will be read; any may be of what is not there.
        """
        decoders = {
            image.identity: _Decoder(image)
            for request, images in wanted.items()
            if request not in self._pending
            for image in images
        }
        self._statistics.count("textures_loaded", len(decoders))
        jobs = [
            (request, [decoders[image.identity] for image in images])
            for request, images in wanted.items()
            if request not in self._pending
        ]
        for _, needed in jobs:
            for decoder in needed:
                decoder.is_spare = decoder.uses == 0
                decoder.uses += 1
        for request, needed in jobs:
            self._pending[request] = self._workers.submit(
                self._make, request, needed, (levels or {}).get(request)
            )

    def handle(self, request: TextureRequest) -> Handle:
        """The texture of a request; raises ImageFileError for a bad image."""
        return self._pending[request].result()

    def close(self) -> None:
        """Stop the workers; textures live as long as their device."""
        self._workers.shutdown(wait=True, cancel_futures=True)

    def _make(
        self,
        request: TextureRequest,
        decoders: "list[_Decoder]",
        read: SampledLevels | None,
    ) -> Handle:
        if (
            len(decoders) == 1
            and image_media_type(decoders[0].image) == "image/ktx2"
        ):
            from moka.renderer.basis_textures import transcode

            with self._statistics.stage("decode"):
                texture = transcode(
                    decoders[0].image, self._device.info, request, read
                )
            if texture is not None:
                return self._device.create_texture(*texture)

        with self._statistics.stage("decode"):
            levels, pixels = self._levels(request, decoders, read)
        height, width = levels[0].shape[:2]
        return self._device.create_texture(
            TextureDescriptor(
                pixels,
                width,
                height,
                levels=len(levels),
                label=decoders[0].image.where,
            ),
            levels,
        )

    def _levels(
        self,
        request: TextureRequest,
        decoders: "list[_Decoder]",
        read: SampledLevels | None,
    ) -> tuple[list[NDArray[Any]], PixelFormat]:
        from moka.core.decode import with_alpha
        from moka.core.mip_levels import reduce_levels

        texels, *others = (decoder.texels() for decoder in decoders)
        height, width = texels.shape[:2]
        texels = _arrange(texels, is_colour=request.is_colour)
        alone = request.bumps is not None and request.graft is None
        if alone and texels.shape[2] == 4:
            # What the file has in an alpha of normals means nothing.
            texels = np.ascontiguousarray(texels[:, :, :3])
        if request.graft is not None:
            texels = _grafted(
                texels, others[0], request.graft, spare=decoders[0].is_spare
            )
        pixels = (
            _COLOUR_FORMATS[texels.shape[2]]
            if request.is_colour
            else _DATA_FORMATS[texels.dtype.str[1:], texels.shape[2]]
        )
        opaque = pixels in _PADDED
        if opaque:
            pixels = _PADDED[pixels]
            texels = with_alpha(texels)
        elif request.bumps is not None and texels.shape[2] == 3:
            white = np.full_like(texels[:, :, :1], np.iinfo(texels.dtype).max)
            texels = np.concatenate([texels, white], axis=2)
            pixels = PixelFormat.RGBA16
        if _is_of_one_colour(texels):
            self._statistics.count("textures_of_one_colour")
            return [np.ascontiguousarray(texels[:1, :1])], pixels
        finest = levels_beyond(
            (width, height),
            self._device.info.max_texture_size,
            request.max_size,
            decoders[0].image.where,
        )
        if request.has_levels and read is not None:
            seen = read.finest(width, height)
            self._statistics.count("textures_reduced", int(seen > finest))
            finest = max(finest, seen)
        if not request.has_levels and not finest:
            return [texels], pixels
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
            )
        return levels if request.has_levels else levels[:1], pixels


def _is_of_one_colour(texels: NDArray[Any]) -> bool:
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


class _Decoder:
    """Decodes an image once, in whichever worker asks first.

    Forgets it when all ``uses`` have asked; ``is_spare`` if it was only one.
    """

    def __init__(self, image: EncodedImage) -> None:
        self.image = image
        self.uses = 0
        self.is_spare = False
        self._lock = threading.Lock()
        self._texels: NDArray[Any] | None = None

    def texels(self) -> NDArray[Any]:
        """The texels (H, W, C); raises ImageFileError."""
        from moka.core.decode import decode_image

        with self._lock:
            texels = self._texels
            if texels is None:
                texels = decode_image(self.image)
            self.uses -= 1
            self._texels = texels if self.uses else None
            return texels


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
