"""Lamps and cameras of files."""

import math
from typing import Any

import numpy as np

from tests.conformance.case import Case
from tests.conformance.materials import reflected
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile

__all__ = ["LIGHTS"]

_WHITE = np.array((0.9, 0.8, 0.7))
_HEIGHT = 0.8
_SPOT = {"innerConeAngle": 0.3, "outerConeAngle": 0.7}


def wall(lamp: dict[str, Any], at: tuple[float, ...]) -> bytes:
    """A wall, and a lamp in front of it that looks at it."""
    file = SceneFile()
    file.node(file.square(file.material(_WHITE, lit=True)))
    file.uses(KHR_lights_punctual={"lights": [lamp]})
    file.node(None, at, extensions={"KHR_lights_punctual": {"light": 0}})
    return file.glb()


def lit(x: Array, y: Array, at: tuple[float, float]) -> tuple[Array, Array]:
    """Radiance of a candela at a place, and the cosine to its axis."""
    offset = np.stack([at[0] - x, at[1] - y, np.full_like(x, _HEIGHT)], -1)
    distance = np.linalg.norm(offset, axis=-1)
    to_light = offset / distance[..., None]
    seen = reflected(_WHITE, 0.0, 1.0, to_light)
    return seen / (distance**2)[..., None], to_light[..., 2]


def painted_point(x: Array, y: Array) -> Array:
    """Two candela, blue light, up to a range of two metres."""
    radiance, cosine = lit(x, y, (0.3, 0.2))
    distance = _HEIGHT / cosine
    window = np.clip(1 - (distance / 2.0) ** 4, 0, 1)
    return radiance * 2 * window[..., None] * (0.5, 0.7, 1.0)


def painted_spot(x: Array, y: Array) -> Array:
    """Three candela, within the cone that the extension recommends."""
    radiance, cosine = lit(x, y, (-0.1, 0.1))
    inner, outer = (math.cos(each) for each in _SPOT.values())
    cone = np.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
    return radiance * 3 * cone[..., None]


def seen_by(camera: dict[str, Any], at: tuple[float, float, float]) -> bytes:
    """A square at the origin, and the camera of the file."""
    file = SceneFile()
    file.node(file.square(file.material((0.2, 0.7, 0.3)), 0.5))
    file.gltf.cameras = [camera]
    file.node(None, at, camera=0)
    return file.glb()


def framed(x: Array, y: Array, centre: Any, half: float) -> Array:
    """The square as the camera sees it."""
    return paint(black(x), inside(x, y, centre, half), (0.2, 0.7, 0.3))


_PERSPECTIVE = {
    "type": "perspective",
    "perspective": {"yfov": 2 * math.atan(0.5), "znear": 0.1},
}
_PARALLEL = {
    "type": "orthographic",
    "orthographic": {"xmag": 2.0, "ymag": 2.0, "znear": 0.1, "zfar": 10},
}

LIGHTS = [
    Case(
        "Point light",
        "a wall, brightest before a bluish lamp with a range",
        "painted: inverse square, window of the range, appendix B",
        lambda: wall(
            {
                "type": "point",
                "intensity": 2.0,
                "color": [0.5, 0.7, 1.0],
                "range": 2.0,
            },
            (0.3, 0.2, _HEIGHT),
        ),
        painted_point,
        options={"multiscatter": False},
    ),
    Case(
        "Spot light",
        "a wall with a soft disc of light",
        "painted: inverse square, smooth cone, appendix B",
        lambda: wall(
            {"type": "spot", "intensity": 3.0, "spot": _SPOT},
            (-0.1, 0.1, _HEIGHT),
        ),
        painted_spot,
        options={"multiscatter": False},
    ),
    Case(
        "Perspective camera",
        "a square a third as high as the picture",
        "painted: half a metre, three away, tan(yfov / 2) = 1 / 2",
        lambda: seen_by(_PERSPECTIVE, (0, 0, 3)),
        lambda x, y: framed(x, y, (0, 0), 0.5 / 3 / 0.5),
        options={"camera": 0},
    ),
    Case(
        "Orthographic camera",
        "a square a quarter as high, low and to the left",
        "painted: half a metre of two, moved by one",
        lambda: seen_by(_PARALLEL, (1, 1, 3)),
        lambda x, y: framed(x, y, (-0.5, -0.5), 0.25),
        options={"camera": 0},
    ),
]
