"""Where the camera of the viewer goes, apart from the pointer's gestures."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from moka.scene.camera import Camera
from moka.scene.camera_choice import Look, Orbit

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["Viewpoint"]


class Viewpoint:
    """Places the camera of a viewer; its ``controls`` go on from there."""

    def __init__(self, viewer: "Viewer") -> None:
        self._viewer = viewer
        self._camera_number = -1

    def follow(self) -> None:
        """Have the camera stand where the controls are."""
        viewer = self._viewer
        viewer.controls.apply(viewer.camera)
        viewer.draft.note_motion()
        viewer.request_redraw()

    def frame_everything(self) -> None:
        """Look at the whole model."""
        self._frame(self._viewer.scene.bounds())

    def frame_selection(self) -> None:
        """Look at the node that is selected, or else at everything."""
        bounds = self._viewer.selected_bounds
        self._frame(self._viewer.scene.bounds() if bounds is None else bounds)

    def forget_cameras(self) -> None:
        """Begin with the first camera: the model is another one."""
        self._camera_number = -1

    def next_camera(self) -> None:
        """Look through the next camera of the file, if it has any."""
        cameras = self._viewer.scene.cameras
        if cameras:
            self._camera_number = (self._camera_number + 1) % len(cameras)
            self.look_through(cameras[self._camera_number])

    def look_through(self, camera: Camera) -> None:
        """Stand where ``camera`` does, free to go on from there."""
        bounds = self._viewer.scene.bounds()
        centre = np.zeros(3) if bounds is None else np.mean(bounds, axis=0)
        distance = float(np.linalg.norm(camera.position - centre)) or 1.0
        self._look_from(camera, distance)

    def look_as(self, look: Look) -> None:
        """Stand where a look is from, and go around its target."""
        self._look_from(look.camera(), math.dist(look.eye, look.target))

    def orbit(self, orbit: Orbit) -> None:
        """Look at the whole model from around it."""
        controls = self._viewer.controls
        controls.yaw = orbit.yaw
        controls.pitch = orbit.pitch
        self.frame_everything()
        if orbit.distance is not None:
            controls.distance = orbit.distance
        self.follow()

    def _look_from(self, camera: Camera, distance: float) -> None:
        viewer = self._viewer
        viewer.camera.projection = camera.projection
        viewer.controls.look_from(camera, distance)
        self.follow()

    def _frame(self, bounds: Any) -> None:
        viewer = self._viewer
        width, height = viewer.size
        viewer.controls.frame(bounds, viewer.camera, width / height)
        self.follow()
