"""Decodes the images that visible materials sample, in worker threads.

The same image used as colour and as data is decoded once and uploaded for
each. Workers reduce the mip levels too, in linear light for colours, so that
the render thread only copies.
"""

import os
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import TextureDescriptor
from moka.commands.handles import Handle
from moka.core.encoded_image import EncodedImage
from moka.core.image_header import image_media_type
from moka.core.log import get_logger
from moka.core.shared_work import shared_with
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.renderer.sampled_levels import SampledLevels
from moka.renderer.texture_levels import (
    arrange_texels,
    is_of_one_colour,
    make_levels,
)
from moka.renderer.texture_request import TextureRequest
from moka.renderer.texture_settings import levels_beyond

__all__ = ["TexturePool"]

_LOGGER = get_logger(__name__)


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
        self._lock = threading.Lock()

    def begin(
        self,
        wanted: Mapping[TextureRequest, Sequence[EncodedImage]],
        levels: Mapping[TextureRequest, SampledLevels] | None = None,
    ) -> None:
        """Begin to decode textures; :meth:`handle` waits for one.

        ``wanted`` has the images that each request names. ``levels`` tells
        which will be read; any may be of what is not there.
        """
        with self._lock:
            self._begin(wanted, levels or {})

    def _begin(
        self,
        wanted: Mapping[TextureRequest, Sequence[EncodedImage]],
        levels: Mapping[TextureRequest, SampledLevels],
    ) -> None:
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
                self._make, request, needed, levels.get(request)
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
            texels, pixels, opaque = arrange_texels(
                request,
                [decoder.texels() for decoder in decoders],
                spare=decoders[0].is_spare,
            )
            if is_of_one_colour(texels):
                self._statistics.count("textures_of_one_colour")
                levels = [np.ascontiguousarray(texels[:1, :1])]
            else:
                height, width = texels.shape[:2]
                finest = self._finest(
                    request, (width, height), decoders[0].image.where, read
                )
                levels = make_levels(
                    request,
                    texels,
                    opaque=opaque,
                    finest=finest,
                    run=shared_with(self._workers),
                )
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

    def _finest(
        self,
        request: TextureRequest,
        size: tuple[int, int],
        where: str,
        read: SampledLevels | None,
    ) -> int:
        """The first level that is held of an image of ``size``."""
        finest = levels_beyond(
            size, self._device.info.max_texture_size, request.max_size, where
        )
        if not request.has_levels or read is None:
            return finest
        seen = read.finest(*size)
        self._statistics.count("textures_reduced", int(seen > finest))
        if seen > finest:
            _LOGGER.debug(
                "%s: %d levels are finer than the picture can show",
                where,
                seen,
            )
        return max(finest, seen)


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
