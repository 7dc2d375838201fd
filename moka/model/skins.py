"""Skins: joints that meshes follow, and which joint moves which vertex.

Source: glTF 2.0 specification, section 3.7.3 (skins).
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.maths import Array
from moka.model import schema
from moka.model.accessors import AccessorReader
from moka.model.mesh import INFLUENCE_SETS, Mesh, Primitive
from moka.model.nodes import NodeTree
from moka.model.source import GltfSource

__all__ = [
    "JointBoxes",
    "Skin",
    "check_skinned",
    "joint_boxes",
    "read_influences",
    "read_skins",
    "skin_matrices",
]

_FLOAT = 5126
# Of a sum of weights, each of them rounded to float32.
_ROUNDING = 5e-7


class Skin(Struct, eq=False):
    """J joints: nodes that move the vertices of the meshes that follow them.

    ``joints`` int32 (J,) are rows of the model's nodes, ``inverse_bind``
    float64 (J, 4, 4) go from the space of the mesh to that of the joint.
    """

    name: str
    joints: NDArray[np.int32]
    inverse_bind: Array


class JointBoxes(Struct, eq=False):
    """Around the vertices that follow each of the K joints in use.

    ``joints`` (K,) are positions in the skin, ``boxes`` float64 (K, 2, 3) in
    the space of the mesh. A vertex is a mean of where its joints would put
    it, so that it stays in the box around the boxes that they move.
    """

    joints: NDArray[np.intp]
    boxes: Array


def skin_matrices(world: Array, inverse_bind: Array) -> Array:
    """Where joints put vertices of a mesh, (..., 4, 4).

    ``world`` (..., 4, 4) are the joints' own matrices. The node that places
    the mesh does not count.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return world @ inverse_bind


def joint_boxes(primitive: Primitive) -> JointBoxes:
    """The boxes of all joints that ``primitive`` follows."""
    positions = primitive.attributes["POSITION"]
    sets = range(primitive.influence_sets)
    joints, weights = (
        np.hstack([primitive.attributes[f"{name}_{n}"] for n in sets])
        for name in ("JOINTS", "WEIGHTS")
    )
    vertex, column = np.nonzero(weights)
    joint = joints[vertex, column].astype(np.uint16)
    order = np.argsort(joint, kind="stable")  # of 16 bits: a radix sort
    used, first = np.unique(joint[order], return_index=True)
    points = positions[vertex[order]]
    boxes = np.stack(
        [
            np.minimum.reduceat(points, first),
            np.maximum.reduceat(points, first),
        ],
        axis=1,
    )
    return JointBoxes(used.astype(np.intp), boxes.astype(np.float64))


def read_skins(source: GltfSource, nodes: NodeTree) -> list[Skin]:
    """All skins. Raises ModelError naming the JSON path of what is wrong.

    ``skeleton`` is only a hint for tools and changes nothing.
    """
    accessors = AccessorReader(source)
    rows = nodes.rows_of_file()
    skins = []
    for index, skin in enumerate(source.document.skins):
        path = f"skins[{index}]"
        for number, joint in enumerate(skin.joints):
            source.check_index(
                f"{path}.joints[{number}]", joint, "nodes", len(rows)
            )
        matrices = _inverse_bind(source, accessors, path, skin)
        skins.append(Skin(skin.name, rows[skin.joints], matrices))
    return skins


def _inverse_bind(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    skin: schema.Skin,
) -> Array:
    count, index = len(skin.joints), skin.inverse_bind_matrices
    if index is None:
        return np.tile(np.eye(4), (count, 1, 1))
    path = f"{path}.inverseBindMatrices"
    document = source.document
    source.check_index(path, index, "accessors", len(document.accessors))
    accessor = document.accessors[index]
    if accessor.type != "MAT4" or accessor.component_type != _FLOAT:
        raise source.error(
            path, f"accessors[{index}] must be MAT4 of 32-bit floats"
        )
    matrices = accessors.floats(index)[:count].astype(np.float64)
    if len(matrices) < count:
        raise source.error(
            path, f"has {len(matrices)} matrices for {count} joints"
        )
    wrong = ~np.isfinite(matrices).all(axis=(1, 2))
    if wrong.any():
        raise source.error(
            path, f"matrix {np.flatnonzero(wrong)[0]} is not finite"
        )
    # The last row must be 0, 0, 0, 1; exporters round it.
    matrices[:, 3] = 0, 0, 0, 1
    return matrices


def read_influences(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    primitive: schema.Primitive,
    vertex_count: int,
) -> dict[str, NDArray[np.float32]]:
    """JOINTS_n and WEIGHTS_n of a primitive, in as few sets as hold them.

    Weights of a vertex are scaled to a sum of 1, which the specification
    asks files to come close to; one without any follows its first joint. Of
    more than twelve joints the strongest count. Raises ModelError naming the
    JSON path of what is wrong.
    """
    given = primitive.attributes
    sets: dict[str, list[NDArray[np.float32]]] = {"JOINTS": [], "WEIGHTS": []}
    count = max(
        sum(name.startswith(f"{kind}_") for name in given) for kind in sets
    )
    for number in range(count):
        for kind, arrays in sets.items():
            name = f"{kind}_{number}"
            if name not in given:
                raise source.error(
                    f"{path}.attributes",
                    f"has no {name}; joints and weights come in pairs, "
                    "counted from 0",
                )
            place = f"{path}.attributes.{name}"
            array = _read_set(
                source, accessors, place, given[name], joints=kind == "JOINTS"
            )
            if len(array) != vertex_count:
                raise source.error(
                    place,
                    f"has {len(array)} elements, POSITION has {vertex_count}",
                )
            arrays.append(array)
    return _arranged(np.hstack(sets["JOINTS"]), np.hstack(sets["WEIGHTS"]))


def _arranged(
    joints: NDArray[np.float32], weights: NDArray[np.float32]
) -> dict[str, NDArray[np.float32]]:
    """Sets of four out of (N, 4 S), the strongest joints first if S > 1."""
    if joints.shape[1] > 4:
        order = np.argsort(-weights, axis=1, kind="stable")
        joints = np.take_along_axis(joints, order, axis=1)
        weights = np.take_along_axis(weights, order, axis=1)
        used = int(np.count_nonzero(weights.any(axis=0)))
        kept = 4 * min(max(1, -(-used // 4)), INFLUENCE_SETS)
        joints, weights = joints[:, :kept], weights[:, :kept]
    total = weights.sum(axis=1, dtype=np.float64, keepdims=True)
    # What differs from 1 by rounding stays, so that saving changes nothing.
    kept = (total == 0) | (np.abs(total - 1) < _ROUNDING)
    weights = (weights / np.where(kept, 1, total)).astype(np.float32)
    weights[total[:, 0] == 0, 0] = 1
    # A joint without weight can be any number, even one that is not there.
    joints = np.where(weights > 0, joints, 0)
    arranged = {}
    for number in range(joints.shape[1] // 4):
        part = slice(4 * number, 4 * number + 4)
        arranged[f"JOINTS_{number}"] = joints[:, part]
        arranged[f"WEIGHTS_{number}"] = weights[:, part]
    return arranged


def _read_set(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    index: int,
    *,
    joints: bool,
) -> NDArray[np.float32]:
    """One JOINTS or WEIGHTS attribute (N, 4)."""
    document = source.document
    source.check_index(path, index, "accessors", len(document.accessors))
    accessor = document.accessors[index]
    kind = accessors.array(index).dtype.str[1:]
    allowed = (
        kind in ("u1", "u2") and not accessor.normalized
        if joints
        else kind == "f4" or (kind in ("u1", "u2") and accessor.normalized)
    )
    if accessor.type != "VEC4" or not allowed:
        raise source.error(
            path,
            f"accessors[{index}] must be VEC4 of "
            + ("plain" if joints else "floats or normalised")
            + " unsigned integers of 8 or 16 bits",
        )
    array = accessors.floats(index)
    wrong = ~((array >= 0) & np.isfinite(array)).all(axis=1)
    if wrong.any():
        raise source.error(
            path,
            f"vertex {np.flatnonzero(wrong)[0]} has a weight below 0 or not "
            "finite",
        )
    return array


def check_skinned(
    source: GltfSource, nodes: NodeTree, meshes: list[Mesh], skins: list[Skin]
) -> None:
    """Raise ModelError if a node's mesh follows joints that its skin lacks."""
    seen: set[tuple[int, int]] = set()
    for row, skin in nodes.skins.items():
        pair = (int(nodes.mesh[row]), skin)
        if pair in seen:
            continue
        seen.add(pair)
        path = f"nodes[{nodes.source[row]}].skin"
        mesh = pair[0]
        count = len(skins[skin].joints)
        for primitive in meshes[mesh].primitives:
            if not primitive.influence_sets:
                raise source.error(
                    path, f"meshes[{mesh}] has no JOINTS_0 to follow it with"
                )
            last = _last_joint(primitive)
            if last >= count:
                raise source.error(
                    path,
                    f"meshes[{mesh}] follows joint {last}, skins[{skin}] has "
                    f"{count}",
                )


def _last_joint(primitive: Primitive) -> int:
    return int(
        max(
            primitive.attributes[f"JOINTS_{number}"].max()
            for number in range(primitive.influence_sets)
        )
    )
