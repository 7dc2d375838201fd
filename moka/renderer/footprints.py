"""How triangles on the screen read a texture: derivatives of coordinates."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.maths import Array

__all__ = ["Footprints", "footprints"]


class Footprints(Struct, frozen=True):
    """How T visible triangles read a texture.

    ``steps`` (2, T) is by how much of the texture's width and height the
    coordinates move from one pixel to the next, at least; ``areas`` (T,) are
    in pixels.
    """

    steps: Array
    areas: Array


def footprints(
    positions: NDArray[np.float32],
    coordinates: Array,
    clip: Array,
    size: tuple[int, int],
    *,
    front: int | None,
) -> Footprints | None:
    """How triangles read a texture, those of them that can be seen.

    ``positions`` (T, 3, 3) and texture ``coordinates`` (T, 3, 2) are of
    their corners, ``clip`` (4, 4) takes positions to clip space with 0 < z <
    w, ``size`` is the picture's in pixels. ``front`` is 1 if triangles that
    turn anticlockwise are seen, -1 if clockwise ones are, None for both.
    None if a triangle may reach behind the near plane, where a texture is as
    large as one likes.

    Of u = (u / w) / (1 / w) both parts change evenly over the screen, so the
    quotient rule gives the derivative at each corner: Heckbert 1989,
    "Fundamentals of Texture Mapping and Image Warping", 3.5. The least of
    three corners stands for a triangle.
    """
    half = 0.5 * np.array(size)[:, None, None]
    with np.errstate(all="ignore"):
        points = positions.swapaxes(0, 1)
        xy = np.array([points @ row[:3] + row[3] for row in clip[:2]])
        z, w = (points @ row[:3] + row[3] for row in clip[2:])
        outside = _all_corners(z > w)
        for side in (xy[0] > w, xy[0] < -w, xy[1] > w, xy[1] < -w):
            outside |= _all_corners(side)
        # Not so for what is not finite.
        before = _all_corners((z <= w) & (w > 0) & (w < np.inf))
        if not (before | outside).all():
            return None
        xy *= half / w
        first, second = xy[:, 1] - xy[:, 0], xy[:, 2] - xy[:, 0]
        twice_area = first[0] * second[1] - first[1] * second[0]
        if not (np.isfinite(twice_area) | outside).all():
            return None
        faces = twice_area * front > 0 if front else twice_area != 0
        seen = np.flatnonzero(faces & ~outside)
        xy, w = xy[:, :, seen], w[:, seen]
        first, second = first[:, seen], second[:, seen]
        twice_area = twice_area[seen]

        def gradient(values: Array) -> Array:
            """Per pixel (2, T), of values (3, T) at the corners."""
            along_first, along_second = values[1:] - values[0]
            turned = along_first * second - along_second * first
            across: Array = np.stack([turned[1], -turned[0]]) / twice_area
            return across

        inverse = 1.0 / w
        by_distance = gradient(inverse)
        steps = np.empty((2, len(seen)))
        for axis in (0, 1):
            value = coordinates[seen, :, axis].T
            by_pixel = gradient(value * inverse)[:, None] - (
                value * by_distance[:, None]
            )
            steps[axis] = (w * np.abs(by_pixel).max(axis=0)).min(axis=0)
    extent = np.clip(xy.max(axis=1), -half[:, 0], half[:, 0])
    extent -= np.clip(xy.min(axis=1), -half[:, 0], half[:, 0])
    areas = np.minimum(0.5 * np.abs(twice_area), extent.prod(axis=0))
    return Footprints(steps, areas)


def _all_corners(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Flags (T,) of triangles, of flags (3, T) of corners."""
    together: NDArray[np.bool_] = flags[0] & flags[1] & flags[2]
    return together
