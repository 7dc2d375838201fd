"""Models for the tests of this folder, made without a file."""

import numpy as np

from moka.model.cameras import CameraDescription
from moka.model.lights import PunctualLight
from moka.model.mesh import Mesh, Primitive
from moka.model.model import Model
from moka.model.nodes import NodeTree


def make_model(
    primitive_counts: list[int],
    meshes: list[int],
    parents: list[int],
    *,
    seed: int = 0,
    cameras: dict[int, CameraDescription] | None = None,
    lights: dict[int, PunctualLight] | None = None,
    names: list[str] | None = None,
) -> Model:
    """A model of random triangles under random matrices.

    ``primitive_counts`` is how many primitives each mesh has, ``meshes`` the
    mesh of each node; cameras and lights are given by node.
    """
    random = np.random.default_rng(seed)
    count = len(meshes)
    local = np.tile(np.eye(4), (count, 1, 1))
    local[:, :3] = random.normal(size=(count, 3, 4))
    cameras, lights = cameras or {}, lights or {}
    nodes = NodeTree(
        names=names or [f"node {i}" for i in range(count)],
        parents=np.array(parents, np.int32),
        local=local,
        mesh=np.array(meshes, np.int32),
        camera=_positions(cameras, count),
        light=_positions(lights, count),
        source=np.arange(count, dtype=np.int32),
    )
    return Model(
        name="test",
        nodes=nodes,
        meshes=[
            Mesh("", [_triangle(random) for _ in range(number)])
            for number in primitive_counts
        ],
        materials=[],
        cameras=list(cameras.values()),
        lights=list(lights.values()),
        scenes=[[i for i, parent in enumerate(parents) if parent < 0]],
        scene_names=[""],
    )


def _triangle(random: np.random.Generator) -> Primitive:
    positions = random.normal(size=(3, 3)).astype(np.float32)
    return Primitive({"POSITION": positions})


def _positions(placed: dict[int, object], count: int) -> np.ndarray:
    result = np.full(count, -1, np.int32)
    result[list(placed)] = np.arange(len(placed))
    return result
