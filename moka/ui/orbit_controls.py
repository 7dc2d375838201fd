"""A camera that goes around a point: by drag, wheel and keys.

The state is a point to look at, a direction to it and a distance, so that
nothing drifts: the camera is made of it anew each time.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace
from numpy.typing import ArrayLike, NDArray

from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.scene.camera_choice import Look

__all__ = ["OrbitControls"]

# Beyond them the picture would be upside down.
_STEEPEST = math.radians(89.9)

# A drag across the window's height turns by half a circle.
_TURN = math.pi

# By what a click of the wheel brings the target nearer.
_ZOOM = 0.88

# The near plane as a part of the distance, as Camera.frame has it.
_NEAR = 1 / 1000
# The far plane of a parallel projection, in distances.
_FAR = 1000.0


class OrbitControls:
    """Where the camera is: ``distance`` metres from ``target`` (3,).

    ``yaw`` and ``pitch`` in radians are those of :meth:`moka.Camera.frame`.
    Motion is in parts of the window's height, so that a gesture does the
    same in a window of any size.
    """

    def __init__(self) -> None:
        self.target: NDArray[np.float64] = np.zeros(3)
        self.yaw = math.radians(30.0)
        self.pitch = math.radians(15.0)
        self.distance = 4.0

    def orbit(self, across: float, down: float) -> None:
        """Turn around the target as if the pointer held the scene."""
        self.yaw -= _TURN * across
        self.pitch = _clamped(self.pitch + _TURN * down)

    def pan(self, across: float, down: float, camera: Camera) -> None:
        """Move the target with the pointer, in the plane of the picture."""
        height = 2.0 * self._half_height(camera)
        self.target = self.target + height * (
            down * self._axis(1) - across * self._axis(0)
        )

    def zoom(
        self,
        clicks: float,
        camera: Camera,
        pointer: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Come nearer by ``clicks`` of the wheel; what is under it stays.

        ``pointer`` is where it is, from the middle of the window, in halves
        of its height, x to the right and y up.
        """
        before = self._half_height(camera)
        factor = _ZOOM**clicks
        self.distance = float(np.clip(self.distance * factor, 1e-9, 1e12))
        lens = camera.projection
        if isinstance(lens, Orthographic):
            camera.projection = Orthographic(
                lens.xmag * factor, lens.ymag * factor, lens.near, lens.far
            )
        shift = before - self._half_height(camera)
        self.target = self.target + shift * (
            pointer[0] * self._axis(0) + pointer[1] * self._axis(1)
        )

    def fly(
        self,
        right: float,
        up: float,
        forward: float,
        turn: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Move camera and target in distances, and look around by ``turn``.

        ``turn`` is across and down, in parts of the window's height.
        """
        eye = self.position
        self.yaw -= _TURN * turn[0]
        self.pitch = _clamped(self.pitch + _TURN * turn[1])
        step = (
            right * self._axis(0) + up * self._axis(1) - forward * self._axis(2)
        )
        self.target = eye + self.distance * step - self.distance * self._axis(2)

    def frame(
        self, bounds: ArrayLike | None, camera: Camera, aspect: float
    ) -> None:
        """Look at the middle of a box (2, 3) from where all of it is seen."""
        camera.frame(bounds, aspect, self.yaw, self.pitch)
        if bounds is not None:
            self.target = np.mean(np.asarray(bounds, np.float64), axis=0)
        else:
            self.target = np.zeros(3)
        self.distance = math.dist(camera.position, self.target)

    def look_from(self, camera: Camera, distance: float | None = None) -> None:
        """Go on from where ``camera`` stands, whatever put it there.

        The target is ``distance`` metres in front of it, by default as far
        away as now.
        """
        world = camera.transform.world_matrix
        back = world[:3, 2] / (np.linalg.norm(world[:3, 2]) or 1.0)
        self.distance = self.distance if distance is None else distance
        self.yaw = math.atan2(back[0], back[2])
        self.pitch = _clamped(math.asin(float(np.clip(back[1], -1.0, 1.0))))
        self.target = world[:3, 3] - self.distance * back

    def set_pivot(self, point: Sequence[float]) -> None:
        """Go around ``point`` from now on, without moving the camera.

        The camera turns to it, since an orbit looks at its target.
        """
        eye = self.position
        towards = np.asarray(point, np.float64) - eye
        distance = float(np.linalg.norm(towards))
        if not distance:
            return
        back = -towards / distance
        self.distance = distance
        self.yaw = math.atan2(back[0], back[2])
        self.pitch = _clamped(math.asin(float(np.clip(back[1], -1.0, 1.0))))
        self.target = np.asarray(point, np.float64)

    def apply(self, camera: Camera) -> None:
        """Put ``camera`` there."""
        world = np.eye(4)
        world[:3, :3] = np.column_stack([self._axis(i) for i in range(3)])
        world[:3, 3] = self.position
        camera.transform.world_matrix = world
        lens = camera.projection
        if isinstance(lens, Perspective):
            near = _NEAR * self.distance
            camera.projection = replace(lens, near=near, far=math.inf)

    def change_lens(self, camera: Camera) -> None:
        """From perspective to parallel, or back; the target looks as large."""
        height = self._half_height(camera)
        if isinstance(camera.projection, Orthographic):
            camera.projection = Camera().projection
            self.distance = height / self._half_height(camera) * self.distance
        else:
            camera.projection = Orthographic(
                height, height, 0.0, _FAR * self.distance
            )
        self.apply(camera)

    def look(self, camera: Camera) -> Look:
        """What ``camera`` sees from here, in numbers."""
        x, y, z = self.position.tolist()
        eye = x, y, z
        x, y, z = self.target.tolist()
        lens = camera.projection
        if isinstance(lens, Orthographic):
            return Look(eye, (x, y, z), height=2.0 * abs(lens.ymag))
        return Look(eye, (x, y, z), lens.yfov)

    @property
    def position(self) -> NDArray[np.float64]:
        """Where the camera is, (3,)."""
        return self.target + self.distance * self._axis(2)

    def _axis(self, column: int) -> NDArray[np.float64]:
        """Right, up or back of the camera."""
        sin_yaw, cos_yaw = math.sin(self.yaw), math.cos(self.yaw)
        sin_pitch, cos_pitch = math.sin(self.pitch), math.cos(self.pitch)
        return np.array(
            (
                (cos_yaw, 0.0, -sin_yaw),
                (-sin_yaw * sin_pitch, cos_pitch, -cos_yaw * sin_pitch),
                (sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch),
            )[column]
        )

    def _half_height(self, camera: Camera) -> float:
        """Half of what the window's height shows at the target, in metres."""
        lens = camera.projection
        if isinstance(lens, Orthographic):
            return abs(lens.ymag)
        return self.distance * math.tan(0.5 * lens.yfov)


def _clamped(pitch: float) -> float:
    return min(max(pitch, -_STEEPEST), _STEEPEST)
