"""Projections, views and the planes of what they show.

Matrices are float64, indexed [row, column]; the camera looks down -Z. Each
projection comes in two forms:

* OpenGL's own clip space, depth -1 (near) to 1 (far);
* ``reversed_z``: depth 1 (near) to 0 (far), for a driver with clip control
  and a float depth buffer, whose precision then is nearly even from the near
  plane to infinity (Reed 2015, "Depth Precision Visualized").

``far`` may be infinite in perspective.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from moka.core.maths import Array, look_rotation

__all__ = ["frustum_planes", "look_at", "orthographic", "perspective"]


def perspective(
    fov_y: float,
    aspect: float,
    near: float,
    far: float,
    *,
    reversed_z: bool = False,
) -> Array:
    """A perspective projection (4, 4).

    ``fov_y`` is the whole vertical angle in radians, ``aspect`` width by
    height, 0 < ``near`` < ``far`` distances in metres.
    """
    matrix = np.zeros((4, 4))
    focal = 1 / math.tan(0.5 * fov_y)
    matrix[0, 0] = focal / aspect
    matrix[1, 1] = focal
    # Written with near / far, so that an infinite far needs no other case.
    ratio = near / far
    if reversed_z:
        matrix[2, 2] = ratio / (1 - ratio)
        matrix[2, 3] = near / (1 - ratio)
    else:
        matrix[2, 2] = -(1 + ratio) / (1 - ratio)
        matrix[2, 3] = -2 * near / (1 - ratio)
    matrix[3, 2] = -1
    return matrix


def orthographic(
    half_width: float,
    half_height: float,
    near: float,
    far: float,
    *,
    reversed_z: bool = False,
) -> Array:
    """An orthographic projection (4, 4).

    Half sizes (glTF's xmag and ymag), ``near`` and ``far`` are in metres;
    ``near`` may be zero or negative.
    """
    matrix = np.eye(4)
    matrix[0, 0] = 1 / half_width
    matrix[1, 1] = 1 / half_height
    depth = far - near
    if reversed_z:
        matrix[2, 2] = 1 / depth
        matrix[2, 3] = far / depth
    else:
        matrix[2, 2] = -2 / depth
        matrix[2, 3] = -(far + near) / depth
    return matrix


def look_at(
    eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0, 1, 0)
) -> Array:
    """The view matrix (4, 4), world to camera, of an eye at a target.

    ``up`` may be parallel to the line of sight; ``eye`` and ``target`` must
    differ.
    """
    eye = np.asarray(eye, np.float64)
    rotation = look_rotation(np.asarray(target, np.float64) - eye, up)
    matrix = np.eye(4)
    matrix[:3, :3] = rotation.T
    matrix[:3, 3] = -rotation.T @ eye
    return matrix


def frustum_planes(
    view_projection: ArrayLike, *, reversed_z: bool = False
) -> Array:
    """The planes (6, 4) of what ``view_projection`` (4, 4) shows.

    Left, right, bottom, top, near, far; p is inside a plane where
    ``plane[:3] @ p + plane[3] >= 0``, in metres, since normals have length
    1. An infinite far plane is (0, 0, 0, 1), which holds everywhere. Source:
    Gribb and Hartmann 2001, "Fast Extraction of Viewing Frustum Planes".
    """
    x, y, z, w = np.asarray(view_projection, np.float64)
    near, far = (w - z, z) if reversed_z else (w + z, w - z)
    planes = np.stack([w + x, w - x, w + y, w - y, near, far])
    length = np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    everywhere = length == 0
    planes /= np.where(everywhere, 1, length)
    return np.where(everywhere, (0.0, 0.0, 0.0, 1.0), planes)
