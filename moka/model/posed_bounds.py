"""The boxes of skinned and morphed meshes in the pose that a file is in."""

import numpy as np

from moka.core.maths import Array, transform_bounds, union_bounds
from moka.model.mesh import Mesh, Primitive
from moka.model.nodes import NodeTree
from moka.model.skins import Skin, skin_matrices

__all__ = ["posed_bounds"]


def posed_bounds(
    nodes: NodeTree, world: Array, row: int, mesh: Mesh, skins: list[Skin]
) -> Array:
    """The box (2, 3) around the mesh that node ``row`` places, in metres.

    ``world`` (N, 4, 4) are the matrices of all ``nodes``. Every vertex is in
    it; it can be larger, see :class:`moka.model.skins.JointBoxes`.
    """
    weights = np.zeros(mesh.target_count, np.float32)
    weights[:] = nodes.weights.get(row, mesh.weights or weights)
    skin = nodes.skins.get(row)
    boxes = []
    for primitive in mesh.primitives:
        spread = np.zeros((2, 3))
        if primitive.targets is not None:
            spread = primitive.targets.spread(weights)
        if skin is None or not primitive.influence_sets:
            boxes.append(
                transform_bounds(
                    world[row], np.array(primitive.bounds, np.float64) + spread
                )
            )
        else:
            boxes.append(_skinned(primitive, world, skins[skin], spread))
    return union_bounds(boxes)


def _skinned(
    primitive: Primitive, world: Array, skin: Skin, spread: Array
) -> Array:
    around = primitive.joint_boxes
    joints = skin.joints[around.joints]
    matrices = skin_matrices(world[joints], skin.inverse_bind[around.joints])
    return union_bounds(transform_bounds(matrices, around.boxes + spread))
