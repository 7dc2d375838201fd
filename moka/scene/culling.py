"""What of the scene a camera can see, for all boxes at once."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.maths import Array

__all__ = ["boxes_in_frustum", "view_depths"]

# Rounding of the plane equations, relative to their largest term. A box is
# only left out if it is outside by more.
_ROUNDING = 1e-12

_FARTHEST = float(np.finfo(np.float32).max)


def boxes_in_frustum(planes: ArrayLike, bounds: ArrayLike) -> NDArray[np.bool_]:
    """Which boxes (N, 2, 3) may reach into the frustum of planes (P, 4).

    Planes are those of :func:`moka.core.projection.frustum_planes`. A box is
    left out only if it lies wholly outside one plane, so that nothing that
    can be seen is; a few boxes near the frustum's edges are kept although
    they cannot. Boxes that are not finite are kept. Source: Assarsson and
    Möller 2000, "Optimized View Frustum Culling Algorithms for Bounding
    Boxes", the basic test of centre and half extent.
    """
    planes = np.asarray(planes, np.float64)
    bounds = np.asarray(bounds, np.float64)
    normals, offsets = planes[:, :3].T, planes[:, 3]
    with np.errstate(over="ignore", invalid="ignore"):
        centre = 0.5 * (bounds[:, 0] + bounds[:, 1])
        extent = 0.5 * (bounds[:, 1] - bounds[:, 0])
        reach = extent @ np.abs(normals)
        largest = np.abs(centre) @ np.abs(normals) + reach + np.abs(offsets)
        distance = centre @ normals + reach + offsets
        outside = distance < -_ROUNDING * largest
    return np.asarray(~outside.any(axis=1))


def view_depths(view_matrix: ArrayLike, bounds: ArrayLike) -> Array:
    """Distances (N,) of box centres along the view axis, in metres.

    Zero for centres behind the camera and for boxes that are not finite, at
    most what float32 holds, since a sort key takes no others.
    """
    bounds = np.asarray(bounds, np.float64)
    row = np.asarray(view_matrix, np.float64)[2]
    with np.errstate(over="ignore", invalid="ignore"):
        centre = 0.5 * (bounds[:, 0] + bounds[:, 1])
        depth = -(centre @ row[:3] + row[3])
    return np.where(np.isfinite(depth), np.clip(depth, 0, _FARTHEST), 0)
