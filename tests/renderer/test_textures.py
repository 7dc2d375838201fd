"""The pool of textures: what is decoded when, and how long it is kept."""

import time
import weakref
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.backend.recording_backend import RecordingBackend
from moka.commands.handles import ResourceKind
from moka.core import decode
from moka.core.encoded_image import EncodedImage
from moka.core.png import write_png
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.material.material import Texture
from moka.renderer.texture_request import texture_request
from moka.renderer.textures import TexturePool


def encoded(seed: int) -> EncodedImage:
    generator = np.random.default_rng(seed)
    file = BytesIO()
    write_png(file, generator.integers(0, 256, (32, 32, 3), np.uint8))
    return EncodedImage(f"image {seed}", data=file.getvalue())


def wait_for(count: int, device: GraphicsDevice) -> None:
    """Until ``count`` textures have been made."""
    deadline = time.monotonic() + 10
    while device.count(ResourceKind.TEXTURE) < count:
        assert time.monotonic() < deadline
        time.sleep(0.001)
    device.finish()


def test_texels_go_with_the_last_texture_that_is_made_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    decoded: list[weakref.ref[NDArray[Any]]] = []
    real = decode.decode_image

    def noted(image: EncodedImage) -> NDArray[Any]:
        texels = real(image)
        decoded.append(weakref.ref(texels))
        return texels

    monkeypatch.setattr(decode, "decode_image", noted)
    image = encoded(1)
    with GraphicsDevice(RecordingBackend) as device:
        pool = TexturePool(device, Statistics())
        requests = [
            texture_request(slot, Texture(image))
            for slot in ("base_colour", "normal")
        ]
        pool.begin({request: [image] for request in requests})
        wait_for(2, device)
        # Nobody has asked for the handles yet.
        pool.close()
        device.finish()
        assert [texels() for texels in decoded] == [None] * len(decoded)
        assert len({pool.handle(request) for request in requests}) == 2
