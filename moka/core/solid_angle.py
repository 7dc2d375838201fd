"""Solid angles, in steradians: cones, spheres, texels of maps.

The solid angle of a set of directions is the area that it covers on the unit
sphere, 4 pi for all of them. Every formula here is exact, and written so
that small angles keep their precision: 1 - cos(x) of a sun of half a degree
would have lost five digits.
"""

import numpy as np
from numpy.typing import ArrayLike

from moka.core.maths import Array

__all__ = [
    "SPHERE",
    "cap_solid_angle",
    "cone_half_angle",
    "cone_solid_angle",
    "cube_texel_solid_angles",
    "equirectangular_texel_solid_angles",
    "sphere_solid_angle",
]

#: All directions, in steradians.
SPHERE = 4.0 * np.pi


def cone_solid_angle(half_angle: ArrayLike) -> Array:
    """Steradians inside cones of ``half_angle`` radians, 0 to pi.

    2 pi (1 - cos t), written as 4 pi sin^2(t / 2).
    """
    return SPHERE * np.sin(0.5 * np.asarray(half_angle, np.float64)) ** 2


def cone_half_angle(solid_angle: ArrayLike) -> Array:
    """Half angles, in radians, of cones of 0 to 4 pi steradians."""
    share = np.asarray(solid_angle, np.float64) / SPHERE
    return np.asarray(2.0 * np.arcsin(np.sqrt(share)))


def cap_solid_angle(height: ArrayLike, radius: ArrayLike = 1.0) -> Array:
    """Steradians of caps of a sphere, seen from its centre.

    ``height`` runs from the plane that cuts the cap off to its pole, 0 to
    twice the ``radius``, in the same unit. The cap's area is 2 pi r h
    (Archimedes: that of the cylinder around it).
    """
    ratio = np.asarray(height, np.float64) / np.asarray(radius, np.float64)
    return 2.0 * np.pi * ratio


def sphere_solid_angle(radius: ArrayLike, distance: ArrayLike) -> Array:
    """Steradians that spheres cover, seen from ``distance`` to the centre.

    2 pi (1 - sqrt(1 - (r / d)^2)), the cone of sin t = r / d, written without
    the difference. Both are metres; the distance is at least the radius.
    """
    radius, distance = np.asarray(radius), np.asarray(distance, np.float64)
    squared: Array = (radius / distance) ** 2
    return 2.0 * np.pi * squared / (1.0 + np.sqrt(1.0 - squared))


def equirectangular_texel_solid_angles(height: int, width: int) -> Array:
    """Steradians (height, width) of an equirectangular map's texels.

    A texel lies between two parallels and two meridians: the difference of
    its edges' cosines times its width in radians. They sum to 4 pi. The
    array is read-only, because all texels of a row share one number.
    """
    centre = (np.arange(height) + 0.5) * (np.pi / height)
    # cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2)
    difference = 2.0 * np.sin(centre) * np.sin(0.5 * np.pi / height)
    rows = difference * (2.0 * np.pi / width)
    return np.broadcast_to(rows[:, None], (height, width))


def cube_texel_solid_angles(size: int) -> Array:
    """Steradians (size, size) of the texels of one face of a cube map.

    The part of a face between its middle and the point (x, y), with the
    face at distance 1, covers atan(x y / sqrt(x^2 + y^2 + 1)); a texel is
    the second difference of that. The six faces sum to 4 pi.
    """
    edges = np.linspace(-1.0, 1.0, size + 1)
    x, y = np.meshgrid(edges, edges)
    to_corner = np.arctan2(x * y, np.sqrt(x * x + y * y + 1.0))
    return np.diff(np.diff(to_corner, axis=0), axis=1)
