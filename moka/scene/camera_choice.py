"""Which camera to look through: by name, by index, or made of numbers."""

import math
import re
from collections.abc import Sequence

from msgspec import Struct

from moka.core.errors import OptionError
from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = [
    "CameraChoice",
    "Look",
    "Orbit",
    "choose_camera",
    "look_text",
    "parse_camera",
]

# Near plane of a look as a part of its distance.
_NEAR = 1 / 1000
# Far plane of one in parallel projection, in distances.
_FAR = 1000.0


class Orbit(Struct, frozen=True):
    """A view of the whole scene from around it; see :meth:`Camera.frame`.

    ``yaw`` and ``pitch`` in radians, ``distance`` from the centre in metres
    or None to fit the picture.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    distance: float | None = None


class Look(Struct, frozen=True):
    """A view from a point of the world to another one, +Y upwards.

    ``eye`` and ``target`` in metres. In perspective ``yfov`` is the vertical
    angle in radians, None for that of :class:`moka.Camera`; with ``height``,
    in metres, the projection is a parallel one that shows so much.
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    yfov: float | None = None
    height: float | None = None

    def camera(self) -> Camera:
        """The camera that looks so."""
        camera = Camera()
        distance = math.dist(self.eye, self.target)
        if self.height is not None:
            half = 0.5 * self.height
            camera.projection = Orthographic(half, half, 0.0, _FAR * distance)
        else:
            lens = camera.projection
            assert isinstance(lens, Perspective)
            camera.projection = Perspective(
                lens.yfov if self.yfov is None else self.yfov,
                near=_NEAR * distance,
            )
        camera.transform.position = self.eye
        camera.transform.look_at(self.target)
        return camera


#: A name or an index of a camera in the models, an orbit, or a look.
CameraChoice = str | int | Orbit | Look


def parse_camera(text: str) -> CameraChoice:
    """What NAME, INDEX, orbit:... or look:... means.

    ``orbit:YAW,PITCH[,DISTANCE]`` is in degrees, pitch from -90 to 90.
    ``look:EX,EY,EZ,TX,TY,TZ[,FOV]`` is from a point to another one, FOV the
    vertical angle in degrees, or with an ``m`` the height in metres of a
    parallel projection. Raises OptionError for an empty name, a negative
    index, and an orbit or a look that is none.
    """
    if text.startswith("orbit:"):
        return _parse_orbit(text)
    if text.startswith("look:"):
        return _parse_look(text)
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
    if isinstance(choice, Look):
        return choice.camera()
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


def look_text(look: Look) -> str:
    """The text that :func:`parse_camera` makes ``look`` of."""
    numbers = [repr(float(each)) for each in (*look.eye, *look.target)]
    if look.height is not None:
        numbers.append(f"{float(look.height)!r}m")
    elif look.yfov is not None:
        numbers.append(repr(math.degrees(look.yfov)))
    return "look:" + ",".join(numbers)


def _parse_look(text: str) -> Look:
    parts = text[len("look:") :].split(",")
    is_parallel = parts[-1].strip().endswith("m")
    if is_parallel:
        parts[-1] = parts[-1].strip()[:-1]
    numbers = _numbers(parts)
    if len(numbers) not in ((7,) if is_parallel else (6, 7)):
        raise OptionError(
            f"camera: {text!r} is not of the form "
            "look:EX,EY,EZ,TX,TY,TZ[,FOV] in metres and degrees"
        )
    x, y, z, *others = numbers
    eye = x, y, z
    x, y, z, *rest = others
    target = x, y, z
    if eye == target:
        raise OptionError(f"camera: {text!r} looks from a point to itself")
    if is_parallel:
        if rest[0] <= 0:
            raise OptionError(
                f"camera: the height of {text!r} must be greater than 0"
            )
        return Look(eye, target, height=rest[0])
    if rest and not 0 < rest[0] < 180:
        raise OptionError(
            f"camera: the angle of {text!r} is not between 0 and 180 degrees"
        )
    return Look(eye, target, math.radians(rest[0]) if rest else None)


def _numbers(parts: Sequence[str]) -> list[float]:
    """Finite numbers, or none at all."""
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []


def _parse_orbit(text: str) -> Orbit:
    numbers = _numbers(text[len("orbit:") :].split(","))
    if not 2 <= len(numbers) <= 3:
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
