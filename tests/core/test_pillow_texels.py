"""Arrays over Pillow's own memory, and copies where that cannot be."""

import gc

import numpy as np
import pytest
from PIL import Image as PillowImage

from moka.core.decode import with_alpha
from moka.core.pillow_texels import pillow_texels


def noise(*shape: int) -> np.ndarray:
    return np.random.default_rng(3).integers(0, 256, shape, np.uint8)


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_pixels_outlive_the_image(channels: int) -> None:
    texels = noise(13, 21, channels)
    result = pillow_texels(PillowImage.fromarray(texels.squeeze()))
    gc.collect()
    others = [PillowImage.new("RGBA", (21, 13), 7) for _ in range(20)]
    np.testing.assert_array_equal(result, texels)
    assert len(others) == 20


def test_three_channels_are_not_copied_again() -> None:
    texels = noise(5, 6, 3)
    result = pillow_texels(PillowImage.fromarray(texels))
    padded = with_alpha(result)
    assert padded.ctypes.data == result.ctypes.data
    np.testing.assert_array_equal(padded[:, :, :3], texels)
    assert (padded[:, :, 3] == 255).all()
    copied = with_alpha(texels)
    np.testing.assert_array_equal(copied, padded)


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA"])
def test_pixels_in_several_pieces_of_memory(mode: str) -> None:
    """Pillow's pieces are of 16 MiB."""
    size = 4200 if mode != "L" else 4200 * 2
    image = PillowImage.linear_gradient("L").convert(mode).resize((size, 2200))
    result = pillow_texels(image)
    channels = len(mode)
    expected = np.asarray(image).reshape(2200, size, channels)
    np.testing.assert_array_equal(result[::50], expected[::50])
