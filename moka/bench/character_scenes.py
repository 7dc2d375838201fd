"""Crowds for ``moka bench scale``: moving, standing, and without joints.

What the three cost tells skinning apart from the geometry that it moves.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.bench.scale_scenes import Subject
from moka.core.maths import compose, quaternion_about_axis
from moka.material.material import Material
from moka.model.assemble import model_of
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Mesh, Primitive
from moka.model.model import Model
from moka.model.nodes import NodeTree
from moka.model.skins import Skin
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["of_characters", "of_standing", "of_statues"]

JOINTS = 50
_RINGS, _SEGMENTS = 100, 50
_HEIGHT, _RADIUS = 1.8, 0.2

Array = NDArray[np.float64]


def of_characters(count: int) -> Subject:
    """``count`` bodies of 50 joints, all of which move in every frame.

    5 000 vertices each, of one mesh and one material, 512 x 512.
    """
    scene, camera = _crowd(_body(has_joints=True), count)
    models = scene.models
    rows = np.stack([model.rows for model in models])[:, :JOINTS]
    phases = np.arange(count)[:, None] + 0.2 * np.arange(JOINTS)

    def advance(frame: int) -> None:
        angles = 0.04 * np.sin(0.1 * frame + phases)
        places = np.zeros((count, JOINTS, 3))
        places[:, 1:, 1] = _HEIGHT / JOINTS
        turns = quaternion_about_axis((0.0, 0.0, 1.0), angles)
        local = compose(places, turns, np.ones(3))
        scene.transforms.set_local(rows.ravel(), local.reshape(-1, 4, 4))

    return Subject(scene, camera, advance, (512, 512))


def of_standing(count: int) -> Subject:
    """The same with joints that stay as they are."""
    scene, camera = _crowd(_body(has_joints=True), count)
    return Subject(scene, camera, _nothing, (512, 512))


def of_statues(count: int) -> Subject:
    """The same without joints."""
    scene, camera = _crowd(_body(has_joints=False), count)
    return Subject(scene, camera, _nothing, (512, 512))


def _nothing(_frame: int) -> None:
    """Leave everything where it is."""


def _crowd(model: Model, count: int) -> tuple[Scene, Camera]:
    scene = Scene()
    scene.background = (0.02, 0.02, 0.03)
    side = int(np.ceil(np.sqrt(count)))
    for number in range(count):
        place = np.eye(4)
        place[:3, 3] = number % side, 0, -(number // side)
        scene.add(model, place)
    scene.add_light(PunctualLight(LightKind.DIRECTIONAL, intensity=3.0))
    camera = Camera()
    camera.frame(scene.bounds(), 1.0, pitch=0.3)
    return scene, camera


def _body(*, has_joints: bool) -> Model:
    """A tube along +Y, each ring of which follows up to four joints."""
    ring = np.linspace(0.0, 1.0, _RINGS)[:, None]
    turn = 2 * np.pi * np.arange(_SEGMENTS) / _SEGMENTS
    across = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], -1)
    radius = _RADIUS * np.sqrt(np.sin(np.pi * (0.02 + 0.96 * ring)))
    points = radius[..., None] * across + ring[..., None] * (0, _HEIGHT, 0)
    attributes: dict[str, ArrayLike] = {
        "POSITION": points.reshape(-1, 3),
        "NORMAL": np.tile(across, (_RINGS, 1)),
    }
    if has_joints:
        joints, weights = _influences(np.repeat(ring[:, 0], _SEGMENTS))
        attributes |= {"JOINTS_0": joints, "WEIGHTS_0": weights}
    column = np.arange(_SEGMENTS)
    beside = (column + 1) % _SEGMENTS
    above, above_beside = column + _SEGMENTS, beside + _SEGMENTS
    quad = np.stack([column, beside, above, beside, above_beside, above], -1)
    starts = _SEGMENTS * np.arange(_RINGS - 1)[:, None, None]
    material = Material(metallic_factor=0.0, roughness_factor=0.6)
    primitive = Primitive(
        attributes, (starts + quad).reshape(-1), material=material
    )
    if not has_joints:
        return model_of([(primitive, material, np.eye(4))])
    return _skinned(primitive, material)


def _influences(along: Array) -> tuple[ArrayLike, ArrayLike]:
    """Joints and weights (N, 4) of vertices ``along`` (N,) a chain, 0..1."""
    place = along * (JOINTS - 1)
    joints = np.clip(np.floor(place)[:, None] + np.arange(-1, 3), 0, JOINTS - 1)
    weights = np.maximum(0.0, 2.0 - np.abs(place[:, None] - joints))
    return joints, weights / weights.sum(axis=1, keepdims=True)


def _skinned(primitive: Primitive, material: Material) -> Model:
    """A chain of joints, and behind it the node of what follows them."""
    count = JOINTS + 1
    local = np.tile(np.eye(4), (count, 1, 1))
    local[1:JOINTS, 1, 3] = _HEIGHT / JOINTS
    parents = np.arange(-1, count - 1, dtype=np.int32)
    parents[JOINTS] = -1
    nothing = np.full(count, -1, np.int32)
    mesh = nothing.copy()
    mesh[JOINTS] = 0
    inverse_bind = np.tile(np.eye(4), (JOINTS, 1, 1))
    inverse_bind[:, 1, 3] = -_HEIGHT / JOINTS * np.arange(JOINTS)
    return Model(
        name="body",
        nodes=NodeTree(
            names=[f"joint {number}" for number in range(JOINTS)] + ["body"],
            parents=parents,
            local=local,
            mesh=mesh,
            camera=nothing,
            light=nothing,
            source=np.arange(count, dtype=np.int32),
            skins={JOINTS: 0},
        ),
        meshes=[Mesh("body", [primitive])],
        materials=[material],
        cameras=[],
        lights=[],
        scenes=[[0, JOINTS]],
        scene_names=[""],
        skins=[Skin("body", np.arange(JOINTS, dtype=np.int32), inverse_bind)],
    )
