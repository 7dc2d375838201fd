"""Keyframes: paths, interpolations and pointers."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pygltflib

from tests.conformance.case import SLANTED_EDGES, Case
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile
from tests.support.oracles.keyframes import sample

__all__ = ["ANIMATIONS", "animate"]

_RED, _GREEN, _BLUE = (0.8, 0.2, 0.1), (0.1, 0.7, 0.2), (0.1, 0.3, 0.9)
_TIME = 0.7
_TIMES = [0.0, 0.5, 1.0]


def animate(
    file: SceneFile,
    target: dict[str, Any],
    times: Sequence[float],
    values: Any,
    interpolation: str = "LINEAR",
    name: str = "move",
) -> None:
    """Add a channel to the animation of a name.

    ``target`` is a node and a path, or a JSON pointer.
    """
    if "pointer" in target:
        file.uses("KHR_animation_pointer")
        target = {
            "path": "pointer",
            "extensions": {"KHR_animation_pointer": target},
        }
    animations = file.gltf.animations
    if not any(each.name == name for each in animations):
        animations.append(pygltflib.Animation(name=name))
    (animation,) = (each for each in animations if each.name == name)
    rows = np.asarray(values, float)
    animation.samplers.append(
        pygltflib.AnimationSampler(
            input=file.accessor(times, limits=True),
            output=file.accessor(rows),
            interpolation=interpolation,
        )
    )
    animation.channels.append(
        pygltflib.AnimationChannel(
            sampler=len(animation.samplers) - 1,
            target=pygltflib.AnimationChannelTarget(**target),
        )
    )


_PLACES = np.array([(-0.7, 0, 0), (0.4, 0.1, 0), (0.7, -0.1, 0)])
_ROWS = [
    ("STEP", 0.6, _RED),
    ("LINEAR", 0.0, _GREEN),
    ("CUBICSPLINE", -0.6, _BLUE),
]
# In-tangent, value and out-tangent of every key.
_SPLINE = np.stack(
    [np.tile((-1.0, 0.5, 0), (3, 1)), _PLACES, np.tile((2.0, -0.5, 0), (3, 1))],
    axis=1,
)


def interpolations() -> bytes:
    """Three squares on one way through the same keyframes."""
    file = SceneFile()
    for kind, y, colour in _ROWS:
        square = file.square(file.material(colour), 0.2)
        moved = file.node(square)
        file.node(None, (0, y), children=[moved])
        spline = kind == "CUBICSPLINE"
        values = _SPLINE.reshape(-1, 3) if spline else _PLACES
        target = {"node": moved, "path": "translation"}
        animate(file, target, _TIMES, values, kind)
    return file.glb()


def painted_interpolations(x: Array, y: Array) -> Array:
    """Where the formulas of appendix C put them."""
    radiance = black(x)
    for kind, row, colour in _ROWS:
        values = _SPLINE if kind == "CUBICSPLINE" else _PLACES
        place = sample(_TIMES, values, kind, _TIME)
        centre = (place[0], place[1] + row)
        paint(radiance, inside(x, y, centre, 0.2), colour)
    return radiance


def _about_z(degrees: float) -> list[float]:
    half = np.radians(degrees) / 2
    return [0.0, 0.0, float(np.sin(half)), float(np.cos(half))]


_TURNS = [_about_z(0), _about_z(80), [-c for c in _about_z(160)]]
_SIZES = np.array([(1, 1, 1), (0.5, 1.5, 1), (1.5, 0.3, 1)])
_BAR = (0.35, 0.15)


def rotation_and_scale() -> bytes:
    """A bar that turns, the last key of the other sign; one that grows."""
    file = SceneFile()
    for path, values, centre, colour in (
        ("rotation", _TURNS, (-0.5, 0), _RED),
        ("scale", _SIZES, (0.5, 0), _BLUE),
    ):
        bar = file.node(file.square(file.material(colour)), scale=[*_BAR, 1.0])
        moved = file.node(children=[bar])
        file.node(None, centre, children=[moved])
        animate(file, {"node": moved, "path": path}, _TIMES, values)
    return file.glb()


def painted_bars(x: Array, y: Array) -> Array:
    """Turned back, a pixel is in the bar or not."""
    radiance = black(x)
    turn = sample(_TIMES, _TURNS, "LINEAR", _TIME, rotates=True)
    angle = 2 * np.arctan2(turn[2], turn[3])
    sine, cosine = np.sin(angle), np.cos(angle)
    u, v = x + 0.5, y
    back = (cosine * u + sine * v, cosine * v - sine * u)
    paint(radiance, inside(*back, (0, 0), _BAR), _RED)
    size = sample(_TIMES, _SIZES, "LINEAR", _TIME)[:2] * _BAR
    return paint(radiance, inside(x, y, (0.5, 0), size), _BLUE)


def pointers() -> bytes:
    """A colour, a texture's place, visibility, and a node's translation."""
    file = SceneFile()
    colours = [(0.9, 0.1, 0.1, 1), (0.1, 0.1, 0.9, 1)]
    first = file.material(colours[0])
    file.node(file.square(first, 0.3), (-0.5, 0.5))
    animate(
        file,
        {"pointer": f"/materials/{first}/pbrMetallicRoughness/baseColorFactor"},
        [0, 1],
        colours,
    )
    file.node(file.square(file.material(_GREEN), 0.3), (0.5, 0.5))
    file.gltf.nodes[-1].extensions = {"KHR_node_visibility": {"visible": True}}
    file.uses("KHR_node_visibility")
    hidden = len(file.gltf.nodes) - 1
    # One byte a key: booleans are such accessors.
    animation = file.gltf.animations[0]
    animation.samplers.append(
        pygltflib.AnimationSampler(
            input=file.accessor([0.0, 0.5], limits=True),
            output=file.accessor(np.array([1, 0]), "u1"),
            interpolation="STEP",
        )
    )
    visible = f"/nodes/{hidden}/extensions/KHR_node_visibility/visible"
    animation.channels.append(
        pygltflib.AnimationChannel(
            sampler=len(animation.samplers) - 1,
            target=pygltflib.AnimationChannelTarget(
                path="pointer",
                extensions={"KHR_animation_pointer": {"pointer": visible}},
            ),
        )
    )
    moved = file.node(file.square(file.material(_BLUE), 0.3), (-0.5, -0.5))
    animate(
        file,
        {"pointer": f"/nodes/{moved}/translation"},
        [0, 1],
        [(-0.5, -0.5, 0), (0.5, -0.5, 0)],
    )
    return file.glb()


def painted_pointers(x: Array, y: Array) -> Array:
    """A mixed colour, nothing, and a square on its way."""
    radiance = black(x)
    mixed = np.array((0.9, 0.1, 0.1)) + _TIME * np.array((-0.8, 0, 0.8))
    paint(radiance, inside(x, y, (-0.5, 0.5), 0.3), mixed)
    return paint(radiance, inside(x, y, (_TIME - 0.5, -0.5), 0.3), _BLUE)


def several() -> bytes:
    """Two animations of one square, to the left and to the right."""
    file = SceneFile()
    moved = file.node(file.square(file.material(_RED), 0.3))
    target = {"node": moved, "path": "translation"}
    for name, end in (("left", -0.5), ("right", 0.5)):
        animate(file, target, [0, 1], [(0, 0, 0), (end, 0, 0)], name=name)
    return file.glb()


_AT = {"time": _TIME}

ANIMATIONS = [
    Case(
        "STEP, LINEAR, CUBICSPLINE",
        "three squares at 0.7 s of one way: behind, on it, and swinging out",
        "painted: appendix C, one channel at a time",
        interpolations,
        painted_interpolations,
        allowed=SLANTED_EDGES,
        options=_AT,
    ),
    Case(
        "Rotation and scale",
        "a bar turned the shorter way, and one that is stretched",
        "painted: the turn as one about an axis",
        rotation_and_scale,
        painted_bars,
        allowed=SLANTED_EDGES,
        options=_AT,
    ),
    Case(
        "KHR_animation_pointer",
        "a square between red and blue; one that went out; one on its way",
        "painted",
        pointers,
        painted_pointers,
        options=_AT,
    ),
    Case(
        "Several animations",
        "a square on its way to the right, by the animation so named",
        "painted",
        several,
        lambda x, y: paint(black(x), inside(x, y, (0.5 * _TIME, 0), 0.3), _RED),
        options={**_AT, "animation": "right"},
    ),
]
