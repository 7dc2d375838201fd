"""Instances, scenes, hidden nodes, variants and levels of detail."""

import numpy as np
import pygltflib

from tests.conformance.case import SLANTED_EDGES, Case
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile

__all__ = ["SCENES"]

_RED, _GREEN, _BLUE = (0.8, 0.2, 0.1), (0.1, 0.7, 0.2), (0.1, 0.3, 0.9)
_RANDOM = np.random.default_rng(5)
_SPOTS = np.stack(np.meshgrid(*[np.linspace(-0.8, 0.8, 9)] * 2), -1)
_SPOTS = _SPOTS.reshape(-1, 2)
_SIZES = _RANDOM.uniform(0.2, 1.0, (81, 2))
_ANGLES = _RANDOM.uniform(-1, 1, 81)
#: Halves of the turns as quaternions' z and w in normalised int16.
_TURNS = np.rint(
    np.column_stack([np.sin(_ANGLES / 2), np.cos(_ANGLES / 2)]) * 32767
)


def instances() -> bytes:
    """One square in 81 places, sizes and turns."""
    file = SceneFile()
    zero = np.zeros(81)
    attributes = {
        "TRANSLATION": file.accessor(np.column_stack([_SPOTS, zero])),
        "SCALE": file.accessor(np.column_stack([_SIZES, zero + 1])),
        "ROTATION": file.accessor(
            np.column_stack([zero, zero, _TURNS]),
            "i2",
            normalized=True,
        ),
    }
    file.uses("EXT_mesh_gpu_instancing")
    file.node(
        file.square(file.material(_RED), 0.09),
        extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    )
    return file.glb()


def painted_instances(x: Array, y: Array) -> Array:
    """Each turned back."""
    radiance = black(x)
    angles = 2 * np.arctan2(*_TURNS.T)
    for spot, size, angle in zip(_SPOTS, _SIZES, angles, strict=True):
        sine, cosine = np.sin(angle), np.cos(angle)
        u, v = x - spot[0], y - spot[1]
        back = (cosine * u + sine * v, cosine * v - sine * u)
        paint(radiance, inside(*back, (0, 0), 0.09 * size), _RED)
    return radiance


def two_scenes(default: int) -> bytes:
    """A red scene and a blue one."""
    file = SceneFile()
    for colour, x in ((_RED, -0.4), (_BLUE, 0.4)):
        file.node(file.square(file.material(colour), 0.3), (x, 0))
    file.gltf.scenes = [
        pygltflib.Scene(name="red", nodes=[0]),
        pygltflib.Scene(name="blue", nodes=[1]),
    ]
    file.gltf.scene = default
    return file.glb()


def left(x: Array, y: Array) -> Array:
    """The red one."""
    return paint(black(x), inside(x, y, (-0.4, 0), 0.3), _RED)


def right(x: Array, y: Array) -> Array:
    """The blue one."""
    return paint(black(x), inside(x, y, (0.4, 0), 0.3), _BLUE)


def hidden() -> bytes:
    """A red square; beside it a blue one below a hidden node."""
    file = SceneFile()
    file.uses("KHR_node_visibility")
    file.node(file.square(file.material(_RED), 0.3), (-0.4, 0))
    child = file.node(file.square(file.material(_BLUE), 0.3))
    file.node(
        None,
        (0.4, 0),
        children=[child],
        extensions={"KHR_node_visibility": {"visible": False}},
    )
    return file.glb()


def variants() -> bytes:
    """A square that is red, and in variants green or blue."""
    file = SceneFile()
    materials = [file.material(c) for c in (_RED, _GREEN, _BLUE)]
    mesh = file.square(materials[0], 0.6)
    (primitive,) = file.gltf.meshes[mesh].primitives
    primitive.extensions = {
        "KHR_materials_variants": {
            "mappings": [
                {"material": materials[1], "variants": [0]},
                {"material": materials[2], "variants": [1]},
            ]
        }
    }
    file.uses(
        KHR_materials_variants={
            "variants": [{"name": "meadow"}, {"name": "sea"}]
        }
    )
    file.node(mesh)
    return file.glb()


def levels() -> bytes:
    """Three copies of an object of two levels, each smaller."""
    file = SceneFile()
    file.uses("MSFT_lod")
    near = file.square(file.material(_RED), 0.5)
    far = file.square(file.material(_BLUE), 0.5)
    for place, size in _COPIES:
        scale = [size] * 3
        # A lower level has no parent of its own.
        lower = file.node(far, place, scale=scale)
        file.node(
            near,
            place,
            scale=scale,
            extensions={"MSFT_lod": {"ids": [lower]}},
            extras={"MSFT_screencoverage": [0.25, 0.01]},
        )
    roots = [1, 3, 5]
    file.gltf.scenes = [pygltflib.Scene(nodes=roots)]
    file.gltf.scene = 0
    return file.glb()


# The sphere around a square of one metre covers 0.39 of the picture; half as
# large 0.1, a tenth as large 0.004.
_COPIES = [((-0.4, 0.4), 1.0), ((0.5, -0.2), 0.5), ((-0.5, -0.6), 0.1)]


def painted_levels(x: Array, y: Array) -> Array:
    """The largest in red, the next in blue, the smallest not at all."""
    radiance = black(x)
    for (place, size), colour in zip(_COPIES, (_RED, _BLUE), strict=False):
        paint(radiance, inside(x, y, place, 0.5 * size), colour)
    return radiance


SCENES = [
    Case(
        "EXT_mesh_gpu_instancing",
        "81 rectangles, each of another size and turn",
        "painted, one by one",
        instances,
        painted_instances,
        allowed=SLANTED_EDGES,
    ),
    Case(
        "The default scene",
        "the blue square, of the scene that the file names",
        "painted",
        lambda: two_scenes(1),
        right,
    ),
    Case(
        "Another scene",
        "the red square, of the scene that was asked for by name",
        "painted",
        lambda: two_scenes(1),
        left,
        options={"scene": "red"},
    ),
    Case(
        "KHR_node_visibility",
        "a red square; a blue one is below a hidden node",
        "painted",
        hidden,
        left,
    ),
    Case(
        "KHR_materials_variants",
        "a blue square, of the variant that was asked for by name",
        "painted",
        variants,
        lambda x, y: paint(black(x), inside(x, y, (0, 0), 0.6), _BLUE),
        options={"variant": "sea"},
    ),
    Case(
        "MSFT_lod",
        "the largest copy red, the next one blue, the smallest not at all",
        "painted, by the share of the picture that a sphere around covers",
        levels,
        painted_levels,
    ),
]
