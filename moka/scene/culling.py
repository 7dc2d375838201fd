"""What of the scene a camera can see, for all boxes at once.

Boxes are laid out as the rows of a matrix, so that the distances of all of
them from all planes are one matrix product.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.maths import Array

__all__ = ["boxes_below", "boxes_in_frustum", "pack_boxes", "view_depths"]

# Rounding of the plane equations, relative to their largest term. A box is
# only left out if it is outside by more.
_ROUNDING = 1e-12

_FARTHEST = float(np.finfo(np.float32).max)


def pack_boxes(bounds: ArrayLike) -> Array:
    """Boxes (6, N), as the other functions read them, of bounds (N, 2, 3).

    Three rows of the centres' coordinates and three of half the extents,
    these larger by what plane equations are rounded by.
    """
    bounds = np.asarray(bounds, np.float64)
    boxes = np.empty((6, len(bounds)))
    with np.errstate(over="ignore", invalid="ignore"):
        boxes[:3] = 0.5 * (bounds[:, 0] + bounds[:, 1]).T
        boxes[3:] = 0.5 * (bounds[:, 1] - bounds[:, 0]).T
        boxes[3:] += _ROUNDING * (np.abs(boxes[:3]) + boxes[3:])
    return boxes


def boxes_in_frustum(planes: ArrayLike, boxes: Array) -> NDArray[np.bool_]:
    """Which boxes (6, N) may reach into the frustum of planes (P, 4).

    Planes are those of :func:`moka.core.projection.frustum_planes`. A box is
    left out only if it lies wholly outside one plane, so that nothing that
    can be seen is; a few boxes near the frustum's edges are kept although
    they cannot. Boxes that are not finite are kept. Source: Assarsson and
    Möller 2000, "Optimized View Frustum Culling Algorithms for Bounding
    Boxes", the basic test of centre and half extent.
    """
    planes = np.asarray(planes, np.float64)
    normals, offsets = planes[:, :3], planes[:, 3:]
    with np.errstate(over="ignore", invalid="ignore"):
        distance = np.hstack([normals, np.abs(normals)]) @ boxes
        distance += offsets + _ROUNDING * np.abs(offsets)
        # Not so for what is not a number.
        outside = (distance < 0.0).any(axis=0)
    return np.asarray(~outside)


def boxes_below(
    part: float, view_matrix: ArrayLike, projection: ArrayLike, boxes: Array
) -> NDArray[np.bool_]:
    """Which boxes (6, N) look smaller than ``part`` of a picture's height.

    ``view_matrix`` and ``projection`` (4, 4) are a camera's. The sphere
    around a box is what counts, from its nearest side and stretched as it
    would be in a corner of the picture, so that none looks smaller than it
    does. Boxes that are not finite, or around the camera, are not.
    """
    projection = np.asarray(projection, np.float64)
    row = np.asarray(view_matrix, np.float64)[2]
    with np.errstate(over="ignore", invalid="ignore"):
        radius = np.sqrt((boxes[3:] ** 2).sum(axis=0))
        if projection[3, 3] != 0:
            return np.asarray(radius * projection[1, 1] < part)
        corner = (1 + np.abs(projection[:2, 2])) / np.diag(projection)[:2]
        stretch = np.sqrt(1 + corner @ corner)
        nearest = -row[:3] @ boxes[:3] - row[3] - radius
        size = radius * (projection[1, 1] * stretch)
        return np.asarray(size < part * nearest)


def view_depths(view_matrix: ArrayLike, boxes: Array) -> Array:
    """Distances (N,) of centres of boxes (6, N) along the view axis, metres.

    Zero for centres behind the camera and for boxes that are not finite, at
    most what float32 holds, since a sort key takes no others.
    """
    row = np.asarray(view_matrix, np.float64)[2]
    with np.errstate(over="ignore", invalid="ignore"):
        depth = -row[:3] @ boxes[:3]
        depth -= row[3]
    return np.where(np.isfinite(depth), np.clip(depth, 0, _FARTHEST), 0)
