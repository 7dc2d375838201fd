"""Animations: what changes over time, as keyframes in arrays.

Source: glTF 2.0 specification, section 3.11 (animations), and
KHR_animation_pointer, which lets channels move more than nodes.
"""

from enum import Enum
from typing import Literal

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.maths import Array, decompose
from moka.model.nodes import NodeTree

__all__ = [
    "PROPERTIES",
    "Animation",
    "AnimationChannel",
    "AnimationTarget",
    "Interpolation",
    "Property",
    "RestPose",
    "rest_transforms",
]

Kind = Literal["node", "material", "light", "camera"]

#: What an animation can move: the kind of thing and the name in moka.
Property = tuple[str, str]

_TEXTURES = (
    "base_colour_texture",
    "metallic_roughness_texture",
    "normal_texture",
    "occlusion_texture",
    "emissive_texture",
)

#: How many numbers each property has; 0 for weights, as many as targets.
PROPERTIES: dict[Property, int] = {
    ("node", "translation"): 3,
    ("node", "rotation"): 4,
    ("node", "scale"): 3,
    ("node", "weights"): 0,
    ("node", "visible"): 1,
    ("material", "base_colour_factor"): 4,
    ("material", "metallic_factor"): 1,
    ("material", "roughness_factor"): 1,
    ("material", "normal_scale"): 1,
    ("material", "occlusion_strength"): 1,
    ("material", "emissive_factor"): 3,
    ("material", "emissive_strength"): 1,
    ("material", "alpha_cutoff"): 1,
    ("material", "ior"): 1,
    ("material", "specular_factor"): 1,
    ("material", "specular_colour_factor"): 3,
    **{
        ("material", f"{texture}.{part}"): width
        for texture in _TEXTURES
        for part, width in (("offset", 2), ("rotation", 1), ("scale", 2))
    },
    ("light", "colour"): 3,
    ("light", "intensity"): 1,
    ("light", "range"): 1,
    ("light", "inner_cone_angle"): 1,
    ("light", "outer_cone_angle"): 1,
    ("camera", "yfov"): 1,
    ("camera", "ymag"): 1,
    ("camera", "near"): 1,
    ("camera", "far"): 1,
}


class Interpolation(Enum):
    """What happens between two keyframes (glTF 2.0, appendix C)."""

    STEP = "STEP"
    LINEAR = "LINEAR"
    CUBICSPLINE = "CUBICSPLINE"


class AnimationTarget(Struct, frozen=True):
    """What a channel moves: a property of one thing of the model.

    ``index`` is the row of a node in ``model.nodes``, or the position of a
    material, light or camera in the model's list. ``property`` is one of
    :data:`PROPERTIES`, those of a texture's transform with a dot, such as
    ``normal_texture.offset``; ``emissive_strength`` multiplies the emissive
    factor. ``element`` is the only morph target whose weight moves, None
    for all of them.
    """

    kind: Kind
    index: int
    property: str
    element: int | None = None


class AnimationChannel(Struct, frozen=True, eq=False):
    """Keyframes of one target.

    ``times`` is float32 (K,), seconds, increasing from 0 or later; channels
    that the file gives the same times share the array. ``values`` is float32
    (K, C), and (K, 3, C) for cubic splines: the tangent before the key, the
    value and the tangent after it, tangents per second. Rotations are
    quaternions (x, y, z, w), angles radians, colours linear Rec.709,
    visibility 0 or 1.
    """

    target: AnimationTarget
    interpolation: Interpolation
    times: NDArray[np.float32]
    values: NDArray[np.float32]


class Animation(Struct, frozen=True, eq=False):
    """Channels that play together.

    ``duration`` is the time of the last keyframe of all channels, in
    seconds. Before its first keyframe a channel has the first value, behind
    its last one the last.
    """

    name: str
    duration: float
    channels: tuple[AnimationChannel, ...]


class RestPose(Struct, frozen=True, eq=False):
    """Where the nodes that animations move are when nothing plays.

    The parts of their matrices as the file has them, since a matrix alone
    does not tell a turned node from a mirrored one: ``nodes`` int32 (A,)
    rows in ``model.nodes``, ``translation`` float64 (A, 3), ``rotation``
    (A, 4) and ``scale`` (A, 3).
    """

    nodes: NDArray[np.int32]
    translation: Array
    rotation: Array
    scale: Array


def rest_transforms(
    tree: NodeTree, known: RestPose | None, rows: NDArray[np.intp]
) -> tuple[Array, Array, Array]:
    """Translations, rotations and scales of nodes when nothing plays.

    As ``known`` has them; the matrices of other nodes are taken apart.
    """
    if known is None:
        return decompose(tree.local[rows])
    if np.array_equal(rows, known.nodes):
        return known.translation, known.rotation, known.scale
    parts = decompose(tree.local[rows])
    given = np.isin(rows, known.nodes)
    source = np.searchsorted(known.nodes, rows[given])
    parts[0][given] = known.translation[source]
    parts[1][given] = known.rotation[source]
    parts[2][given] = known.scale[source]
    return parts
