"""Decodes the images that visible materials sample, in worker threads.

The same image used as colour and as data is decoded once and uploaded for
each. Workers reduce the mip levels too, in linear light for colours, so that
the render thread only copies.
"""

import os
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    MipmapMode,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.core.encoded_image import EncodedImage
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.material.material import Texture

__all__ = ["TexturePool", "TextureRequest"]

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

COLOUR_SLOTS = frozenset({"base_colour", "emissive"})


@dataclass(frozen=True, slots=True)
class TextureRequest:
    """An image and how the GPU is to hold it."""

    identity: str
    is_colour: bool
    has_levels: bool

    @classmethod
    def of(cls, slot: str, texture: Texture) -> "TextureRequest":
        """What slot ``slot`` of a material needs of ``texture``."""
        return cls(
            texture.image.identity,
            slot in COLOUR_SLOTS,
            texture.sampler.mipmap is not MipmapMode.NONE,
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
        self._decoded: dict[str, Future[NDArray[Any]]] = {}
        self._pending: dict[TextureRequest, Future[Handle]] = {}

    def request(self, slot: str, texture: Texture) -> TextureRequest:
        """Begin to decode a texture; :meth:`handle` waits for it."""
        request = TextureRequest.of(slot, texture)
        if request not in self._pending:
            decoded = self._decode(texture.image)
            self._pending[request] = self._workers.submit(
                self._make, request, decoded, texture.image.where
            )
            self._statistics.count("textures_loaded")
        return request

    def handle(self, request: TextureRequest) -> Handle:
        """The texture of a request; raises ImageFileError for a bad image."""
        handle = self._pending[request].result()
        self._decoded.pop(request.identity, None)
        return handle

    def close(self) -> None:
        """Stop the workers; textures live as long as their device."""
        self._workers.shutdown(wait=True, cancel_futures=True)

    def _decode(self, image: EncodedImage) -> "Future[NDArray[Any]]":
        future = self._decoded.get(image.identity)
        if future is None:
            future = self._workers.submit(self._timed_decode, image)
            self._decoded[image.identity] = future
        return future

    def _timed_decode(self, image: EncodedImage) -> NDArray[Any]:
        from moka.core.decode import decode_image

        with self._statistics.stage("decode"):
            return decode_image(image)

    def _make(
        self,
        request: TextureRequest,
        decoded: "Future[NDArray[Any]]",
        where: str,
    ) -> Handle:
        from moka.core.mip_levels import reduce_levels

        # Decoding was submitted before, so a worker is on it or done.
        texels = decoded.result()
        with self._statistics.stage("decode"):
            texels, pixels = _arrange(texels, is_colour=request.is_colour)
            levels = (
                reduce_levels(texels, srgb=request.is_colour)
                if request.has_levels
                else [texels]
            )
        height, width = texels.shape[:2]
        return self._device.create_texture(
            TextureDescriptor(
                pixels, width, height, levels=len(levels), label=where
            ),
            levels,
        )


def _arrange(
    texels: NDArray[Any], *, is_colour: bool
) -> tuple[NDArray[Any], PixelFormat]:
    """Texels and the format that holds them with the least loss.

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
    channels = texels.shape[2]
    if is_colour:
        if texels.dtype == np.uint16:
            # There is no 16-bit sRGB format.
            texels = ((texels.astype(np.uint32) + 128) // 257).astype(np.uint8)
        return texels, _COLOUR_FORMATS[channels]
    return texels, _DATA_FORMATS[texels.dtype.str[1:], channels]
