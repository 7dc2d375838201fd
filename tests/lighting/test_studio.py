"""The studio: lamps where they flatter, and none behind the object."""

import numpy as np

from moka.lighting.equirectangular import mean_radiance, texel_directions
from moka.lighting.studio import studio


def test_radiance_is_sound_and_moderate() -> None:
    pixels = studio().pixels
    assert pixels.shape == (256, 512, 3)
    assert np.isfinite(pixels).all()
    assert pixels.min() > 0.01
    assert pixels.max() < 12.0
    assert (np.abs(mean_radiance(pixels) - 0.75) < 0.15).all()


def test_light_is_nearly_white() -> None:
    mean = mean_radiance(studio().pixels)
    assert mean.max() / mean.min() < 1.05


def test_map_closes_at_its_seam_and_its_poles() -> None:
    pixels = studio().pixels
    across = np.abs(pixels[:, 0] - pixels[:, -1]).max()
    within = np.abs(np.diff(pixels, axis=1)).max()
    assert across <= within
    for pole in (pixels[0], pixels[-1]):
        assert np.ptp(pole, axis=0).max() < 0.05 * pole.max()


def test_edges_are_soft() -> None:
    # No texel is brighter than its neighbour by half of the brightest lamp.
    pixels = studio().pixels
    for axis in (0, 1):
        assert np.abs(np.diff(pixels, axis=axis)).max() < 4.0


def test_key_light_is_on_the_upper_left_of_the_camera() -> None:
    pixels = studio().pixels
    directions = texel_directions(*pixels.shape[:2])
    brightest = pixels.sum(axis=2) > 0.9 * pixels.sum(axis=2).max()
    x, y, z = directions[brightest].mean(axis=0)
    assert x < -0.3
    assert y > 0.3
    assert z > 0.3


def test_camera_sees_backdrop_behind_the_object() -> None:
    pixels = studio().pixels
    x, y, z = np.moveaxis(texel_directions(*pixels.shape[:2]), -1, 0)
    # 16:9 with a vertical field of view of 50 degrees, towards -Z.
    half = np.tan(np.radians(25.0))
    seen = (z < 0) & (np.abs(y) < -z * half) & (np.abs(x) < -z * half * 16 / 9)
    assert pixels[seen].max() < 0.8
