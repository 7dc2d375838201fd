"""An outdoor environment made by formulas, as a camera would have taken it.

A clear sky with clouds of noise, hills before the horizon, and a sun that is
170 000 times as bright as the mean, blurred by a lens over a few texels: what
the maps of panoramas hold, from none of them.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from moka.lighting.equirectangular import mean_radiance, texel_directions

Array = NDArray[np.float64]

HEIGHT = 512
SUN = np.array([0.46, 0.55, 0.70]) / np.linalg.norm([0.46, 0.55, 0.70])
#: Of the brightest texel, times the mean of the map.
PEAK = 170_000.0

_OCTAVES = 4


@cache
def outdoors(height: int = HEIGHT) -> NDArray[np.float32]:
    """The map (H, 2H, 3), linear Rec.709; always the same."""
    directions = texel_directions(height, 2 * height).astype(np.float32)
    cosine = directions @ SUN
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))[..., None]
    up = directions[..., 1:2]
    # Bluer towards the zenith, hazy at the horizon, a glow around the sun.
    gradient = np.maximum(up, 0.0) ** 0.45
    sky = np.array([0.95, 1.05, 1.15]) * (1.0 - gradient)
    sky = sky + np.array([0.16, 0.34, 0.78]) * gradient
    sky = sky * (
        1.0 + 3.0 * np.exp(-9.0 * angle) + 0.3 * cosine[..., None] ** 2
    )
    clouds = _noise(directions * [2.2, 5.5, 2.2] + 40.0)
    cover = np.clip(2.6 * (clouds - 0.52), 0.0, 0.9)[..., None]
    lit = 1.1 + 1.6 * np.exp(-3.0 * angle)
    sky = sky * (1.0 - cover) + lit * np.array([1.0, 0.97, 0.93]) * cover
    # Grass and soil in patches, and hills that stand against the sky.
    soil = _noise(directions * 14.0)[..., None]
    ground = np.array([0.10, 0.13, 0.05]) * (0.5 + soil)
    ground = ground + np.array([0.10, 0.07, 0.04]) * soil**2
    azimuth = np.arctan2(directions[..., 2], directions[..., 0])
    hills = 0.05 + 0.035 * np.sin(3 * azimuth + 1) + 0.02 * np.sin(11 * azimuth)
    pixels = np.where(up > hills[..., None], sky, ground)
    # A lens spreads the disc over texels: most of it over one, some farther.
    texel = np.pi / height
    blur = np.exp(-((angle / (0.55 * texel)) ** 2))
    blur = blur + 1e-4 / (1.0 + (angle / (2.0 * texel)) ** 3)
    sun = blur / blur.max() * np.array([1.0, 0.93, 0.80])
    # The peak is to be PEAK times a mean that it is itself a part of.
    without, of_sun = mean_radiance(pixels).mean(), mean_radiance(sun).mean()
    pixels = pixels + PEAK * without / (1.0 - PEAK * of_sun) * sun
    return pixels.astype(np.float32)


def _noise(places: Array) -> Array:
    """Value noise of several octaves, 0 to 1, at places (..., 3)."""
    total = np.zeros(places.shape[:-1])
    for octave in range(_OCTAVES):
        total += _value_noise(places * 2.0**octave, octave) / 2.0**octave
    return total / (2.0 - 2.0 ** (1 - _OCTAVES))


def _value_noise(places: Array, seed: int) -> Array:
    """Random numbers at the corners of cells, mixed smoothly between."""
    table = np.random.default_rng(seed).random((64, 64, 64), np.float32)
    corner = np.floor(places).astype(int)
    s, t, u = np.moveaxis((x := places - corner) * x * (3.0 - 2.0 * x), -1, 0)
    i, j, k = np.moveaxis(corner, -1, 0) % 64
    i1, j1, k1 = (i + 1) % 64, (j + 1) % 64, (k + 1) % 64

    def mix(a: Array, b: Array, share: Array) -> Array:
        return a + (b - a) * share

    return mix(
        mix(
            mix(table[i, j, k], table[i1, j, k], s),
            mix(table[i, j1, k], table[i1, j1, k], s),
            t,
        ),
        mix(
            mix(table[i, j, k1], table[i1, j, k1], s),
            mix(table[i, j1, k1], table[i1, j1, k1], s),
            t,
        ),
        u,
    )
