"""What a camera contributes to a frame, with the origin at the camera.

World coordinates reach the GPU relative to the camera, subtracted in double
precision, so that a scene a million metres from zero keeps its detail.
"""

import math

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from moka.core.maths import Array
from moka.model.cameras import Perspective
from moka.scene.camera import Camera

__all__ = ["View", "look_through", "turn_matrix"]

# Logarithmic depth ends at this many near distances, and everything beyond
# is equally far. Float32 then has steps of 3e-6 of the distance at most.
_DEPTH_RATIO = 2.0**64
# An infinite far plane as a float32.
_FARTHEST = float(np.finfo(np.float32).max)
# Of a box the corners: every choice of a lower or an upper end on each axis.
_AXES = np.arange(3)
_ENDS = np.arange(8)[:, np.newaxis] >> _AXES & 1


class View(Struct, frozen=True):
    """Camera matrices of one frame, float64, [row, column].

    ``position`` is the camera in the world, ``matrix`` world to camera,
    ``projection`` camera to clip space, ``clip_from_world`` the same from
    world axes with their origin at the camera. ``depth_range`` is for
    logarithmic depth: near and far distance and 1 / log2(far / near); None
    where depth is what the projection says.
    """

    position: Array
    matrix: Array
    projection: Array
    clip_from_world: Array
    depth_range: tuple[float, float, float] | None = None

    @property
    def is_perspective(self) -> bool:
        """Whether rays meet in one point."""
        return bool(self.projection[3, 3] == 0)

    @property
    def eye(self) -> Array:
        """(4,): from a point p towards the viewer is xyz - p * w."""
        if self.is_perspective:
            return np.array([0.0, 0.0, 0.0, 1.0])
        # Parallel rays: everything is seen along the camera's own axis.
        return np.append(self.matrix[2, :3], 0.0)

    def jittered(
        self, offset: tuple[float, float], size: tuple[int, int]
    ) -> "View":
        """The view through another point of every pixel.

        ``offset`` is in pixels from their centres, ``size`` the picture's.
        """
        shift = np.eye(4)
        # What lies at the offset moves to the centre.
        shift[:2, 3] = -2.0 * np.array(offset) / size
        return replace(
            self,
            projection=shift @ self.projection,
            clip_from_world=shift @ self.clip_from_world,
        )

    def rectangle_of(
        self, box: Array, size: tuple[int, int]
    ) -> tuple[int, int, int, int] | None:
        """The pixels that a world ``box`` (2, 3) can touch, with one around.

        As x, y, width and height from the lower left of a picture of
        ``size``; None where it reaches behind the camera, or beyond what can
        be computed, and may be anywhere.
        """
        clip = self.clip_from_world
        with np.errstate(over="ignore", invalid="ignore"):
            corners = box[_ENDS, _AXES] - self.position
            x, y, _, w = clip[:, :3] @ corners.T + clip[:, 3:]
            if not (w > 1e-6 * np.abs(corners).max()).all():
                return None
            places = (np.stack([x, y]) / w * 0.5 + 0.5).T * size
        low, high = places.min(axis=0).tolist(), places.max(axis=0).tolist()
        if not all(map(math.isfinite, (*low, *high))):
            return None
        (left, right), (bottom, top) = (
            (
                min(max(math.floor(first) - 1, 0), side),
                min(max(math.ceil(last) + 1, 0), side),
            )
            for first, last, side in zip(low, high, size, strict=True)
        )
        return left, bottom, right - left, top - bottom

    def direction_from_clip(self, environment_rotation: float) -> Array:
        """(4, 4): clip (x, y, 0, 1) to a direction of the environment.

        ``environment_rotation`` is in radians about +Y; the direction is in
        the environment's own space and not of unit length.
        """
        camera_from_clip = np.zeros((4, 4))
        camera_from_clip[2, 3] = -1.0
        if self.is_perspective:
            # Where z is -1; the third column shifts the picture.
            for axis in (0, 1):
                scale, shift = self.projection[axis, [axis, 2]]
                camera_from_clip[axis, [axis, 3]] = 1 / scale, shift / scale
        world_from_camera = np.eye(4)
        world_from_camera[:3, :3] = self.matrix[:3, :3].T
        turn = np.eye(4)
        turn[:3, :3] = turn_matrix(environment_rotation)
        return turn @ world_from_camera @ camera_from_clip


def look_through(camera: Camera, aspect: float, *, reversed_z: bool) -> View:
    """The view of ``camera`` for a picture of ``aspect`` (width by height).

    Without ``reversed_z``, which needs clip control, depth in perspective is
    logarithmic: OpenGL's own has nothing left for what is a few thousand
    times as far away as the near plane.
    """
    matrix = camera.view_matrix
    lens = camera.projection
    projection = camera.projection_matrix(aspect, reversed_z=reversed_z)
    depth_range = None
    if isinstance(lens, Perspective) and not reversed_z:
        # The shader cuts at the far plane: in float32 near / far is lost in
        # the third row, and with it all that is far would be clipped.
        projection[2, 2:] = -1.0, -2.0 * lens.near
        ratio = min(lens.far / lens.near, _DEPTH_RATIO)
        depth_range = (
            lens.near,
            min(lens.far, _FARTHEST),
            1.0 / math.log2(ratio),
        )
    rotation = np.eye(4)
    rotation[:3, :3] = matrix[:3, :3]
    return View(
        camera.position,
        matrix,
        projection,
        projection @ rotation,
        depth_range,
    )


def turn_matrix(rotation: float) -> Array:
    """(3, 3): world directions to those of an environment turned by radians.

    The environment turns counter-clockwise about +Y seen from above, so its
    own directions turn back; ``turn_into_environment`` of the shaders.
    """
    cosine, sine = math.cos(rotation), math.sin(rotation)
    return np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])
