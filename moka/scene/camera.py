"""A camera: where it stands and how it projects.

It looks down its -Z axis. The picture's aspect is not the camera's: it comes
with the picture, and a camera keeps its vertical angle or height.
"""

import math

import numpy as np
from msgspec.structs import replace
from numpy.typing import ArrayLike

from moka.core import projection as projections
from moka.core.errors import OptionError
from moka.core.maths import Array, forward_directions, look_rotation
from moka.model.cameras import CameraDescription, Orthographic, Perspective
from moka.scene.transform import Transform

__all__ = ["Camera"]

_DEFAULT = Perspective(yfov=math.radians(45))

# Near plane of a framing camera as a part of its distance. Even 24 bits of
# evenly spaced depth then tell 6e-6 of the distance apart at the target.
_NEAR = 0.01


class Camera:
    """A transform and a projection.

    The default looks from the origin along -Z with a vertical angle of 45
    degrees, from 1 cm to infinity. ``transform`` moves it; scale above it in
    a hierarchy does not change what it sees (glTF 2.0, 3.10.2).

    Raises OptionError for a projection that could show nothing.
    """

    def __init__(
        self,
        projection: Perspective | Orthographic = _DEFAULT,
        transform: Transform | None = None,
        name: str = "",
    ) -> None:
        self.projection = projection
        self.transform = Transform() if transform is None else transform
        self.name = name
        # The world matrix that was last asked about, and its view matrix.
        self._viewed: tuple[Array, Array] | None = None

    @classmethod
    def from_description(
        cls,
        description: CameraDescription,
        transform: Transform | None = None,
    ) -> "Camera":
        """The camera that a file describes, placed by ``transform``."""
        return cls(description.projection, transform, description.name)

    def __repr__(self) -> str:
        return f"<Camera {self.name!r}: {self.projection}, {self.transform!r}>"

    @property
    def projection(self) -> Perspective | Orthographic:
        """How it projects; replace it to change it.

        The aspect of a perspective and the ``xmag`` of an orthographic
        projection are only what a file says; the picture decides.
        """
        return self._projection

    @projection.setter
    def projection(self, value: Perspective | Orthographic) -> None:
        _check(value)
        self._projection = value

    @property
    def position(self) -> Array:
        """Where the camera is in the world, in metres, float64 (3,)."""
        return self.transform.world_matrix[:3, 3]

    @property
    def view_matrix(self) -> Array:
        """World to camera, float64 (4, 4): a rotation and a translation."""
        world = self.transform.world_matrix
        # A frame asks for it several times.
        if self._viewed is None or not np.array_equal(world, self._viewed[0]):
            rotation = look_rotation(forward_directions(world), world[:3, 1])
            view = np.eye(4)
            view[:3, :3] = rotation.T
            view[:3, 3] = -rotation.T @ world[:3, 3]
            self._viewed = world.copy(), view
        return self._viewed[1].copy()

    def projection_matrix(
        self, aspect: float, *, reversed_z: bool = False
    ) -> Array:
        """Camera to clip space, float64 (4, 4).

        ``aspect`` is width by height of the picture. Depth is OpenGL's, or
        with ``reversed_z`` 1 at the near plane and 0 at the far one; see
        :mod:`moka.core.projection`.
        """
        lens = self._projection
        if isinstance(lens, Perspective):
            return projections.perspective(
                lens.yfov, aspect, lens.near, lens.far, reversed_z=reversed_z
            )
        height = abs(lens.ymag)
        return projections.orthographic(
            height * aspect, height, lens.near, lens.far, reversed_z=reversed_z
        )

    def frustum_planes(self, aspect: float) -> Array:
        """The planes (6, 4) in the world of what the camera sees.

        See :func:`moka.core.projection.frustum_planes`. They come from the
        reversed projection, whose planes are exact at any near and far.
        """
        matrix = self.projection_matrix(aspect, reversed_z=True)
        return projections.frustum_planes(
            matrix @ self.view_matrix, reversed_z=True
        )

    def frame(
        self,
        bounds: ArrayLike | None,
        aspect: float,
        yaw: float = 0.0,
        pitch: float = 0.0,
        distance: float | None = None,
    ) -> None:
        """Look at the centre of a box (2, 3) so that all of it is seen.

        ``yaw`` and ``pitch`` in radians say from where: 0, 0 is from +Z,
        yaw goes counter-clockwise seen from above (towards +X), pitch
        upwards. ``distance`` in metres is from the centre; by default the
        sphere around the box just fits into a picture of ``aspect``. The
        planes of the projection are set for that distance. Without
        ``bounds`` (nothing to see) the unit sphere at the origin is framed.

        Raises OptionError for bounds that are not finite, and values that
        mean no direction or distance.
        """
        centre, radius = _sphere(bounds)
        if not math.isfinite(yaw) or not math.isfinite(pitch):
            raise OptionError("camera: yaw and pitch must be finite")
        if distance is None:
            distance = self._fitting_distance(radius, aspect)
        if not 0 < distance < math.inf:
            raise OptionError("camera: the distance must be greater than 0")
        lens = self._projection
        if isinstance(lens, Perspective):
            near = _NEAR * distance
            self.projection = replace(lens, near=near, far=math.inf)
        else:
            height = radius / min(1.0, aspect)
            self.projection = Orthographic(
                height * aspect, height, 0.0, distance + 2 * radius
            )
        world = np.eye(4)
        world[:3, :3] = _orbit_rotation(yaw, pitch)
        world[:3, 3] = centre + distance * world[:3, 2]
        self.transform.world_matrix = world

    def _fitting_distance(self, radius: float, aspect: float) -> float:
        """From where a sphere touches the nearer edges of the picture."""
        lens = self._projection
        if isinstance(lens, Orthographic):
            return 2 * radius
        half_height = 0.5 * lens.yfov
        half_width = math.atan(math.tan(half_height) * aspect)
        return radius / math.sin(min(half_height, half_width))


def _orbit_rotation(yaw: float, pitch: float) -> Array:
    """Columns right, up, back of a camera on a sphere around its target.

    Made of the angles themselves, so that straight up and down are nothing
    special.
    """
    sin_yaw, cos_yaw = math.sin(yaw), math.cos(yaw)
    sin_pitch, cos_pitch = math.sin(pitch), math.cos(pitch)
    return np.array(
        [
            [cos_yaw, -sin_yaw * sin_pitch, sin_yaw * cos_pitch],
            [0, cos_pitch, sin_pitch],
            [-sin_yaw, -cos_yaw * sin_pitch, cos_yaw * cos_pitch],
        ]
    )


def _sphere(bounds: ArrayLike | None) -> tuple[Array, float]:
    """Centre and radius of the sphere around a box; never a radius of 0."""
    if bounds is None:
        return np.zeros(3), 1.0
    box = np.asarray(bounds, np.float64)
    if box.shape != (2, 3) or not np.isfinite(box).all():
        raise OptionError(
            "camera: the bounds to frame must be 2x3 finite numbers; "
            "is a transform of the scene too large?"
        )
    centre = 0.5 * (box[0] + box[1])
    return centre, 0.5 * math.dist(box[0], box[1]) or 1.0


def _check(projection: Perspective | Orthographic) -> None:
    """Raise OptionError for a projection that could show nothing."""
    near, far = projection.near, projection.far
    if isinstance(projection, Perspective):
        if not 0 < projection.yfov < math.pi:
            raise OptionError("camera: yfov must lie between 0 and pi radians")
        if not 0 < near < far:
            raise OptionError("camera: 0 < near < far does not hold")
    else:
        if not 0 < abs(projection.ymag) < math.inf:
            raise OptionError("camera: ymag must be finite and not 0")
        if not -math.inf < near < far < math.inf:
            raise OptionError("camera: near < far, both finite, does not hold")
