"""Skins and morph targets."""

from typing import Any

import numpy as np
import pygltflib

from tests.conformance.animations import animate
from tests.conformance.case import SLANTED_EDGES, Case
from tests.conformance.painting import (
    Array,
    black,
    inside,
    paint,
    srgb_to_linear,
)
from tests.conformance.scene_file import SceneFile, png

__all__ = ["CHARACTERS"]

_RED, _BLUE = (0.8, 0.2, 0.1), (0.1, 0.3, 0.9)
_CORNERS = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)


def _skinned(
    file: SceneFile,
    material: int,
    corners: Array,
    joints: list[int],
    influences: list[tuple[Array, Array]],
    inverse_bind: Array | None = None,
) -> int:
    """A node of a square whose corners follow joints, in sets of four."""
    attributes: dict[str, Any] = {"POSITION": corners}
    for number, (which, weights) in enumerate(influences):
        attributes[f"JOINTS_{number}"] = file.accessor(which, "u1")
        attributes[f"WEIGHTS_{number}"] = file.accessor(weights)
    mesh = file.mesh(attributes, [0, 1, 2, 0, 2, 3], material)
    skin = pygltflib.Skin(joints=joints)
    if inverse_bind is not None:
        skin.inverseBindMatrices = file.accessor(
            inverse_bind.transpose(0, 2, 1).reshape(-1, 16)
        )
    file.gltf.skins.append(skin)
    # Where the node of a skinned mesh is means nothing.
    return file.node(
        mesh,
        (7, 8, 9),
        scale=[3, 2, 1],
        skin=len(file.gltf.skins) - 1,
    )


def _all_of_one(joint: int) -> tuple[Array, Array]:
    which = np.tile((joint, 0, 0, 0), (4, 1))
    return which, np.tile((1.0, 0, 0, 0), (4, 1))


_ANGLE = 0.7


def bent() -> bytes:
    """A bar whose halves hang on two joints, the second one turned."""
    file = SceneFile()
    half = np.sin(_ANGLE / 2), np.cos(_ANGLE / 2)
    tip = file.node(None, (0.5, 0), rotation=[0, 0, *map(float, half)])
    root = file.node(None, (-0.4, -0.3), children=[tip])
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[1, 0, 3] = -0.5
    for joint, colour, left in ((0, _RED, 0.0), (1, _BLUE, 0.5)):
        corners = (_CORNERS + 1) * (0.25, 0.1, 0) + (left, -0.1, 0)
        material = file.material(colour)
        _skinned(
            file,
            material,
            corners,
            [root, tip],
            [_all_of_one(joint)],
            inverse,
        )
    return file.glb()


def painted_bend(x: Array, y: Array) -> Array:
    """The second half turned about its joint."""
    radiance = black(x)
    paint(radiance, inside(x, y, (-0.15, -0.3), (0.25, 0.1)), _RED)
    u, v = x - 0.1, y + 0.3
    sine, cosine = np.sin(_ANGLE), np.cos(_ANGLE)
    back = (cosine * u + sine * v, cosine * v - sine * u)
    return paint(radiance, inside(*back, (0.25, 0), (0.25, 0.1)), _BLUE)


def eight_joints() -> bytes:
    """A square that follows the mean of eight joints, in two sets."""
    file = SceneFile()
    places = np.linspace(-0.9, 0.9, 8)
    joints = [file.node(None, (x, x / 2)) for x in places]
    file.node(None, children=joints)
    weights = _WEIGHTS.reshape(2, 4)
    influences = [
        (
            np.tile(np.arange(4 * part, 4 * part + 4), (4, 1)),
            np.tile(weights[part], (4, 1)),
        )
        for part in (0, 1)
    ]
    _skinned(file, file.material(_RED), _CORNERS * 0.3, joints, influences)
    return file.glb()


_WEIGHTS = np.array((1, 0, 2, 3, 4, 5, 0, 1)) / 16


def painted_mean(x: Array, y: Array) -> Array:
    """At the mean of their places by their weights."""
    middle = float(np.linspace(-0.9, 0.9, 8) @ _WEIGHTS)
    return paint(black(x), inside(x, y, (middle, middle / 2), 0.3), _RED)


def unequal_scale() -> bytes:
    """Two meshes on one skeleton; a joint is scaled, and a nested one too."""
    file = SceneFile()
    inner = file.node(None, (1, 0), scale=[0.5, 2, 1])
    outer = file.node(None, (-0.5, 0), scale=[1, 0.25, 1], children=[inner])
    for joint, colour in ((0, _RED), (1, _BLUE)):
        _skinned(
            file,
            file.material(colour),
            _CORNERS * 0.4,
            [outer, inner],
            [_all_of_one(joint)],
        )
    return file.glb()


def painted_scales(x: Array, y: Array) -> Array:
    """Scales multiply; places are scaled by what is above them."""
    radiance = black(x)
    paint(radiance, inside(x, y, (-0.5, 0), (0.4, 0.1)), _RED)
    return paint(radiance, inside(x, y, (0.5, 0), (0.2, 0.2)), _BLUE)


_TEXELS = np.array([[(200, 40, 40), (40, 200, 40)]] * 2)


def morphed() -> bytes:
    """Targets of positions, of colours and of texture coordinates."""
    file = SceneFile()
    texture = file.texture(png(_TEXELS), magFilter=9728, minFilter=9728)
    targets: list[tuple[tuple[float, float], dict[str, Array], int]] = [
        (
            (-0.5, 0.5),
            {"POSITION": np.array([(0.4, 0, 0)] * 4)},
            file.material(_RED),
        ),
        (
            (0.5, 0.5),
            {"COLOR_0": np.array([(-0.8, 0.4, 0.4)] * 4)},
            file.material(),
        ),
        (
            (-0.5, -0.5),
            {"TEXCOORD_0": np.array([(1.0, 0.0)] * 4)},
            file.material(texture=texture),
        ),
    ]
    for place, target, material in targets:
        extra = {"COLOR_0": np.ones((4, 3))} if "COLOR_0" in target else {}
        mesh = file.square(material, 0.25, **extra)
        (primitive,) = file.gltf.meshes[mesh].primitives
        # The second target has no weight.
        primitive.targets = [
            {
                name: file.accessor(scale * values, limits=name == "POSITION")
                for name, values in target.items()
            }
            for scale in (1, 100)
        ]
        file.gltf.meshes[mesh].weights = [0.5, 0.0]
        file.node(mesh, place)
    # An animation's weights count before those of the mesh.
    again = file.gltf.nodes[0].mesh
    moved = file.node(again, (0.3, -0.5))
    animate(
        file,
        {"node": moved, "path": "weights"},
        [0.0, 1.0],
        np.array([0.0, 0.0, 1.0, 0.0]),
    )
    return file.glb()


def painted_morphs(x: Array, y: Array) -> Array:
    """Half of every target, and three quarters of the animated one."""
    radiance = black(x)
    paint(radiance, inside(x, y, (-0.3, 0.5), 0.25), _RED)
    # Half of the sum would be 1.2: colours are clamped to 1.
    paint(radiance, inside(x, y, (0.5, 0.5), 0.25), (0.6, 1, 1))
    # Half a texture further, where its other texel is.
    left, right = srgb_to_linear(_TEXELS[0] / 255)
    both = np.where((x < -0.5)[..., None], right, left)
    paint(radiance, inside(x, y, (-0.5, -0.5), 0.25), both)
    return paint(radiance, inside(x, y, (0.6, -0.5), 0.25), _RED)


CHARACTERS = [
    Case(
        "Skin",
        "a bar, bent upwards by 0.7 radians in its middle",
        "painted: each half is rigid; the node's place means nothing",
        bent,
        painted_bend,
        allowed=SLANTED_EDGES,
    ),
    Case(
        "Eight influences",
        "a square among eight joints of two sets",
        "painted: at the mean of the joints by their weights",
        eight_joints,
        painted_mean,
    ),
    Case(
        "Unequal scale, nested and shared joints",
        "a flat red rectangle and a blue square",
        "painted",
        unequal_scale,
        painted_scales,
    ),
    Case(
        "Morph targets",
        "moved; turned from white to cyan; texels in turn; moved by animation",
        "painted: half of each target, three quarters at 0.75 s",
        morphed,
        painted_morphs,
        options={"time": 0.75},
    ),
]
