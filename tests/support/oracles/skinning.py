"""Skins and morph targets vertex by vertex in float64, from the formulas.

Source: glTF 2.0 specification, sections 3.7.2.2 and 3.7.3.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Vertices", "deform", "world_matrices"]

Array = NDArray[np.float64]
# Attributes of vertices: POSITION (N, 3), NORMAL (N, 3), TANGENT (N, 4), ...
Vertices = Mapping[str, ArrayLike]


def world_matrices(parents: Sequence[int], local: ArrayLike) -> Array:
    """Matrices (N, 4, 4) of nodes below one another, -1 for no parent."""
    local = np.asarray(local, np.float64)
    world: list[Array] = []
    for node, parent in enumerate(parents):
        above = np.eye(4) if parent < 0 else world[parent]
        world.append(above @ local[node])
    return np.array(world)


def deform(
    vertices: Vertices,
    *,
    targets: Sequence[Vertices] = (),
    weights: Sequence[float] = (),
    joints: ArrayLike | None = None,
    influences: ArrayLike | None = None,
    joint_world: ArrayLike = (),
    inverse_bind: ArrayLike = (),
    node_world: ArrayLike | None = None,
) -> dict[str, Array]:
    """Vertices in the world: morphed, then moved by joints or their node.

    ``joints`` and ``influences`` (N, K) say which joints of J move a vertex
    and how much of each; without them ``node_world`` (4, 4) does.
    """
    result = {
        name: np.array(array, np.float64) for name, array in vertices.items()
    }
    for target, weight in zip(targets, weights, strict=True):
        for name, delta in target.items():
            delta = np.asarray(delta, np.float64)
            result[name][:, : delta.shape[1]] += weight * delta
    for vertex in range(len(result["POSITION"])):
        if joints is None or influences is None:
            matrix = np.asarray(node_world, np.float64)
        else:
            matrix = np.zeros((4, 4))
            total = float(np.sum(np.asarray(influences)[vertex], dtype=float))
            for joint, influence in zip(
                np.asarray(joints)[vertex],
                np.asarray(influences, np.float64)[vertex],
                strict=True,
            ):
                if influence:
                    matrix += (influence / total) * (
                        np.asarray(joint_world)[joint]
                        @ np.asarray(inverse_bind)[joint]
                    )
        _place(result, vertex, matrix)
    return result


def _place(result: dict[str, Array], vertex: int, matrix: Array) -> None:
    linear = matrix[:3, :3]
    point = result["POSITION"][vertex]
    result["POSITION"][vertex] = linear @ point + matrix[:3, 3]
    if "NORMAL" in result:
        normal = np.linalg.inv(linear).T @ result["NORMAL"][vertex]
        result["NORMAL"][vertex] = normal / np.linalg.norm(normal)
    if "TANGENT" in result:
        tangent = result["TANGENT"][vertex]
        along = linear @ tangent[:3]
        tangent[:3] = along / np.linalg.norm(along)
        tangent[3] *= np.sign(np.linalg.det(linear))
