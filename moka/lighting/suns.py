"""Suns: the few bright, compact parts of an environment, as lights.

A sun is a handful of texels that are 1e4 to 1e5 times as bright as the rest
and carry half of the flux. Neither prefiltering nor nine spherical harmonics
nor half floats can cope with that; a light with the exact BRDF can. So an
environment is split into a base map of low dynamic range and suns, which
together have exactly the flux of the map, channel by channel.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.lighting.environment import AUTO_SUNS, Environment, Sun
from moka.lighting.equirectangular import (
    direction_to_uv,
    solid_angles,
    uv_to_direction,
)

__all__ = [
    "AUTO_SUNS",
    "SplitEnvironment",
    "extract_suns",
    "full_map",
    "split_environment",
]

Pixels = NDArray[np.float32]
Array = NDArray[np.float64]

# The base map is cut at this many times the mean radiance. Measured against
# exact integration, split-sum of what is left has errors of 3 %.
_LIMIT = 8.0
# What a sun has at least of the flux of its environment; a weaker spot
# changes no picture enough to be worth a light.
_LEAST_SHARE = 0.01
# Steradians it fills at most (a radius of 2 degrees), glare not counted. A
# window or a soft box is larger, and as a point its light would be wrong.
_LARGEST = 0.004
# So the peak of a sun is at least this many times the mean. It is what most
# environments without one fail, for the price of a maximum.
_LEAST_PEAK = _LEAST_SHARE * 4.0 * np.pi / _LARGEST

# Of a map of suns in uniform light: they are a degree wide in it.
_ROWS_OF_UNIFORM = 128


class SplitEnvironment(Struct, frozen=True, eq=False):
    """An environment twice: as a whole, and as a base and suns.

    ``full`` is the map, ``base`` what is left when suns that were found in it
    are taken out; both are float32 (H, W, 3), or (1, 1, 3) for a uniform
    environment, and the same array where none was found. The environment's
    own suns are in neither.
    """

    full: Pixels
    base: Pixels
    suns: tuple[Sun, ...]


def split_environment(
    environment: Environment, most: int = AUTO_SUNS, *, search: bool = True
) -> SplitEnvironment:
    """Split ``environment`` into a base and at most ``most`` suns.

    Its own suns come first. Those that are too many are drawn into the map.
    Without ``search`` no others are looked for.
    """
    own = _own_suns(environment)
    full = full_map(environment, most)
    left = max(most - len(own), 0) if search else 0
    base, found = extract_suns(full, left)
    return SplitEnvironment(full, base, (*own[:most], *found))


def full_map(environment: Environment, most: int = AUTO_SUNS) -> Pixels:
    """The ``full`` of :func:`split_environment`."""
    return _with_suns(environment.pixels, _own_suns(environment)[most:])


def _own_suns(environment: Environment) -> list[Sun]:
    """The brightest first."""
    return sorted(environment.suns, key=lambda sun: -sum(sun.irradiance))


def extract_suns(
    pixels: Pixels, most: int = AUTO_SUNS
) -> tuple[Pixels, tuple[Sun, ...]]:
    """The base of a map, and up to ``most`` suns that it lacks.

    ``pixels`` is an equirectangular map, float32 (H, W, 3), finite and not
    negative. A sun is a connected set of texels above eight times the mean
    radiance that fills few steradians with a good share of the flux. Its
    texels keep the colour that they had, darkened to eight times the mean;
    what that takes away is the sun's irradiance, so that base and suns have
    the flux of the map. Suns come brightest first. Without any the base is
    ``pixels`` itself.
    """
    height, width, _ = pixels.shape
    if height == 1 or most < 1:
        return pixels, ()
    # Not luminance, which would overlook a blue lamp.
    brightness = pixels @ np.full(3, 1.0 / 3.0, np.float32)
    rows = solid_angles(height, width)[:, 0]
    mean = float(rows.astype(np.float32) @ brightness.sum(axis=1)) / (4 * np.pi)
    if brightness.max() <= _LEAST_PEAK * mean:
        return pixels, ()
    texels = np.flatnonzero(brightness > _LIMIT * mean)
    values = brightness.ravel()[texels].astype(np.float64)
    part = _components(texels, height, width)
    areas = rows[texels // width]
    excess = values - _LIMIT * mean
    flux = np.bincount(part, excess * areas)
    # How large an even disc would have to be to vary as much.
    size = flux * flux / np.bincount(part, excess * excess * areas)
    is_sun = (flux >= _LEAST_SHARE * 4 * np.pi * mean) & (size <= _LARGEST)
    chosen = np.argsort(np.where(is_sun, -flux, np.inf), kind="stable")
    chosen = chosen[: min(most, np.count_nonzero(is_sun))]
    if not len(chosen):
        return pixels, ()
    base = pixels.copy()
    flat = base.reshape(-1, 3)
    suns = []
    for number in chosen:
        of_sun = texels[part == number]
        bright = flat[of_sun]
        scale = _LIMIT * mean / values[part == number]
        flat[of_sun] = bright * scale[:, np.newaxis].astype(np.float32)
        taken = bright.astype(np.float64) - flat[of_sun]
        suns.append(_sun(of_sun, taken, height, width))
    return base, tuple(suns)


def _sun(
    texels: NDArray[np.intp], taken: Array, height: int, width: int
) -> Sun:
    """The light that sends what was ``taken`` (N, 3) from ``texels`` (N,)."""
    row, column = np.divmod(texels, width)
    directions = uv_to_direction(
        np.stack([(column + 0.5) / width, (row + 0.5) / height], axis=-1)
    )
    areas = solid_angles(height, width)[row, 0]
    irradiance = areas @ taken
    weights = areas * taken.sum(axis=1)
    weights /= weights.sum()
    mean = weights @ directions
    length = float(np.linalg.norm(mean))
    # A disc of radius R has a mean squared angle of R^2 / 2 from its centre.
    # That of the texels' centres is twice 1 - length; and a texel, which a
    # lookup spreads over two of its widths, adds a third of its area.
    spread = 4.0 * max(1.0 - length, 0.0) + weights @ areas * 2.0 / 3.0
    x, y, z = (mean / length).tolist()
    red, green, blue = irradiance.tolist()
    radius = float(np.sqrt(spread))
    return Sun((x, y, z), (red, green, blue), radius, in_map=True)


def _components(
    texels: NDArray[np.intp], height: int, width: int
) -> NDArray[np.intp]:
    """Numbers of connected sets of ``texels``, ascending flat indices.

    Texels are connected by sides and corners, around the seam, and at a
    pole all with each other. Labels sink along edges to the smallest and
    then along themselves (Shiloach and Vishkin 1982), which takes a few
    passes whatever the shape.
    """
    row, column = np.divmod(texels, width)
    edges = []
    for down, right in ((0, 1), (1, -1), (1, 0), (1, 1)):
        beside = (row + down) * width + (column + right) % width
        place = np.minimum(np.searchsorted(texels, beside), len(texels) - 1)
        joined = np.flatnonzero(texels[place] == beside)
        edges.append(np.stack([joined, place[joined]]))
    for pole in (0, height - 1):
        around = np.flatnonzero(row == pole)
        edges.append(np.stack([around[:-1], around[1:]]))
    one, other = np.concatenate(edges, axis=1)
    labels = np.arange(len(texels))
    while True:
        lower = np.minimum(labels[one], labels[other])
        sunk = labels.copy()
        np.minimum.at(sunk, labels[one], lower)
        np.minimum.at(sunk, labels[other], lower)
        sunk = sunk[sunk]
        if np.array_equal(sunk, labels):
            return np.unique(labels, return_inverse=True)[1]
        labels = sunk


def _with_suns(pixels: Pixels, suns: list[Sun]) -> Pixels:
    """``pixels`` with the discs of ``suns`` drawn in, their flux exact.

    One texel for all directions becomes a map.
    """
    if not suns:
        return pixels
    if pixels.shape[:2] == (1, 1):
        pixels = np.tile(pixels, (_ROWS_OF_UNIFORM, 2 * _ROWS_OF_UNIFORM, 1))
    height, width, _ = pixels.shape
    drawn = pixels.copy()
    rows = solid_angles(height, width)[:, 0]
    for sun in suns:
        uv = direction_to_uv(_disc(sun)) * (width, height)
        column = uv[:, 0].astype(np.intp) % width
        row = np.minimum(uv[:, 1].astype(np.intp), height - 1)
        texels, counts = np.unique(row * width + column, return_counts=True)
        share = counts / (len(uv) * rows[texels // width])
        drawn.reshape(-1, 3)[texels] += share[:, np.newaxis] * np.array(
            sun.irradiance
        )
    return drawn


def _disc(sun: Sun, count: int = 1024) -> Array:
    """Unit directions (count, 3), evenly over the disc (Vogel 1979)."""
    centre = np.array(sun.direction)
    tangent = np.cross(centre, np.eye(3)[np.argmin(np.abs(centre))])
    tangent /= np.linalg.norm(tangent)
    index = np.arange(count) + 0.5
    radius = np.tan(sun.angular_radius) * np.sqrt(index / count)
    angle = index * np.pi * (3.0 - np.sqrt(5.0))
    plane = radius * np.stack([np.cos(angle), np.sin(angle)])
    axes = np.stack([tangent, np.cross(centre, tangent)])
    directions: Array = centre + plane.T @ axes
    return directions
