"""Which camera to look through: by name, by index, or an orbit."""

import math
import re

from msgspec import Struct

from moka.core.errors import OptionError
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["CameraChoice", "Orbit", "choose_camera", "parse_camera"]


class Orbit(Struct, frozen=True):
    """A view of the whole scene from around it; see :meth:`Camera.frame`.

    ``yaw`` and ``pitch`` in radians, ``distance`` from the centre in metres
    or None to fit the picture.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    distance: float | None = None


#: A name or an index of a camera in the models, or an orbit.
CameraChoice = str | int | Orbit


def parse_camera(text: str) -> CameraChoice:
    """What NAME, INDEX or orbit:YAW,PITCH[,DISTANCE] means.

    Angles in the text are degrees, pitch from -90 to 90. Raises OptionError
    for an empty name, a negative index and an orbit that is none.
    """
    if text.startswith("orbit:"):
        return _parse_orbit(text)
    if re.fullmatch(r"[+-]?[0-9]{1,9}", text):
        index = int(text)
        if index < 0:
            raise OptionError(f"camera: the index {text} is negative")
        return index
    if not text:
        raise OptionError("camera: the name is empty")
    return text


def choose_camera(
    scene: Scene, choice: CameraChoice | None, aspect: float
) -> Camera:
    """The camera that ``choice`` names, for a picture of ``aspect``.

    None takes the first camera of the models, and without one an orbit that
    frames the scene from the front. Raises OptionError, listing the cameras
    that there are, for one that is not there.
    """
    cameras = scene.cameras
    if choice is None and cameras:
        return cameras[0]
    if choice is None or isinstance(choice, Orbit):
        orbit = choice or Orbit()
        camera = Camera()
        camera.frame(
            scene.bounds(), aspect, orbit.yaw, orbit.pitch, orbit.distance
        )
        return camera
    if isinstance(choice, int):
        if 0 <= choice < len(cameras):
            return cameras[choice]
    else:
        for camera in cameras:
            if camera.name == choice:
                return camera
    listed = ", ".join(
        f"{index} {camera.name!r}" for index, camera in enumerate(cameras)
    )
    raise OptionError(
        f"camera: there is no camera {choice!r}; the scene has "
        f"{listed or 'none, try orbit:YAW,PITCH'}"
    )


def _parse_orbit(text: str) -> Orbit:
    try:
        numbers = [float(part) for part in text[len("orbit:") :].split(",")]
    except ValueError:
        numbers = []
    if not 2 <= len(numbers) <= 3 or not all(map(math.isfinite, numbers)):
        raise OptionError(
            f"camera: {text!r} is not of the form orbit:YAW,PITCH[,DISTANCE] "
            "in degrees and metres"
        )
    yaw, pitch, *rest = numbers
    if abs(pitch) > 90:
        raise OptionError(f"camera: the pitch of {text!r} is beyond 90 degrees")
    if rest and rest[0] <= 0:
        raise OptionError(
            f"camera: the distance of {text!r} must be greater than 0"
        )
    distance = rest[0] if rest else None
    return Orbit(math.radians(yaw), math.radians(pitch), distance)
