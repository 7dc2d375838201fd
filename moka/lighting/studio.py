"""The built-in ``studio``: soft boxes before a seamless grey backdrop.

Product photography in its usual form: a large key light to the upper left
of the camera, a wide weaker fill on the right, two strips behind the object
that draw bright edges, and a bank of light overhead. The camera is expected
at +Z; what it sees behind the object is backdrop and no lamp.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.lighting.environment import Environment
from moka.lighting.equirectangular import texel_directions

__all__ = ["studio"]

Array = NDArray[np.floating[Any]]

_HEIGHT = 256


@dataclass(frozen=True, slots=True)
class _SoftBox:
    """A rectangle of light on a plane at distance 1, facing the object.

    Angles are degrees: ``azimuth`` from -Z, which is behind the object, to
    the right, ``elevation`` over the horizon. ``width`` and ``height`` are
    half of its extent, ``softness`` half of the width of its edge.
    """

    azimuth: float
    elevation: float
    width: float
    height: float
    radiance: tuple[float, float, float]
    softness: float = 0.05

    def add_to(self, pixels: Array, directions: Array) -> None:
        """Add its radiance to the ``pixels`` (H, W, 3) of ``directions``."""
        a, e = math.radians(self.azimuth), math.radians(self.elevation)
        right = np.array([math.cos(a), 0.0, math.sin(a)])
        up = np.array(
            [
                -math.sin(a) * math.sin(e),
                math.cos(e),
                math.cos(a) * math.sin(e),
            ]
        )
        depth = directions @ np.cross(up, right)
        # Directions to the plane no further out than the corners.
        reach = math.hypot(self.width, self.height) + 2.0 * self.softness
        near = depth > 1.0 / math.hypot(1.0, reach)
        depth, towards = depth[near], directions[near]
        x = np.abs(towards @ right) / depth
        y = np.abs(towards @ up) / depth
        # The distance to a rectangle with round corners, negative inside.
        across = x - self.width + self.softness
        along = y - self.height + self.softness
        distance = np.hypot(np.maximum(across, 0.0), np.maximum(along, 0.0))
        distance += np.minimum(np.maximum(across, along), 0.0) - self.softness
        cover = _smooth_step(self.softness, -self.softness, distance)
        # The diffuser is brightest in the middle, before its lamp.
        cover *= 1.0 - 0.2 * ((x / self.width) ** 2 + (y / self.height) ** 2)
        pixels[near] += cover[:, np.newaxis] * np.array(self.radiance)


_SOFT_BOXES = (
    # Key, fill, overhead, and the strips on the left and on the right.
    _SoftBox(-138.0, 36.0, 0.44, 0.44, (7.0, 6.8, 6.5)),
    _SoftBox(122.0, 16.0, 0.36, 0.56, (1.7, 1.75, 1.85), softness=0.10),
    _SoftBox(0.0, 86.0, 0.50, 0.26, (2.6, 2.6, 2.6), softness=0.08),
    _SoftBox(-70.0, 12.0, 0.09, 0.62, (4.2, 4.3, 4.5)),
    _SoftBox(74.0, 16.0, 0.08, 0.56, (4.8, 4.8, 4.8)),
)


@cache
def studio() -> Environment:
    """The studio, always the same; its mean radiance is about 0.6."""
    directions = texel_directions(_HEIGHT, 2 * _HEIGHT)
    pixels = _backdrop(directions)
    for box in _SOFT_BOXES:
        box.add_to(pixels, directions)
    return Environment(pixels.astype(np.float32), name="studio")


def _backdrop(directions: Array) -> Array:
    """Paper that hangs behind the object and runs on below it.

    A spot lights it from behind the object; it darkens upwards and towards
    the camera's side of the room.
    """
    y = directions[..., 1]
    spot = directions @ (np.array([0.0, 0.12, -1.0]) / math.hypot(0.12, 1.0))
    wall = 0.16 + 0.42 * np.exp((spot - 1.0) / 0.22)
    wall *= 1.0 - 0.65 * _smooth_step(0.15, 0.95, y)
    floor = 0.28 - 0.10 * _smooth_step(-0.4, -1.0, y)
    grey = wall + (floor - wall) * _smooth_step(0.05, -0.55, y)
    paper: Array = grey[..., np.newaxis] * np.array([0.985, 1.0, 1.03])
    return paper


def _smooth_step(start: float, stop: float, values: Array) -> Array:
    """0 before ``start``, 1 after ``stop``, a cubic between them."""
    t = np.clip((values - start) / (stop - start), 0.0, 1.0)
    step: Array = t * t * (3.0 - 2.0 * t)
    return step
