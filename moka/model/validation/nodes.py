"""Nodes and scenes: one tree, transforms that are transforms.

Source: glTF 2.0 specification, section 3.5 (scenes, nodes).
"""

import math
from typing import Any

import numpy as np

from moka.model.validation.context import CheckedFile, float_of
from moka.model.validation.hierarchy import is_node, list_of, on_loops
from moka.model.validation.issues import Place

__all__ = ["check_nodes"]

# Of a quaternion's length, as the Khronos validator has it.
_UNIT_ERROR = 0.00769
_TRS = ("translation", "rotation", "scale")
#: Transforms that change nothing.
_IDENTITIES: dict[str, tuple[int, ...]] = {
    "translation": (0, 0, 0),
    "rotation": (0, 0, 0, 1),
    "scale": (1, 1, 1),
    "matrix": (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1),
}


def check_nodes(file: CheckedFile) -> list[int]:
    """Check all nodes and scenes; the parent of each node, -1 for roots."""
    parents = _parents(file)
    for number in on_loops(parents):
        file.add("NODE_LOOP", ("nodes", number), "is its own ancestor")
    for number, node in file.all("nodes"):
        place = ("nodes", number)
        _check_transform(file, node, place)
        _check_mesh(file, node, place)
        if "skin" in node and "mesh" in node and parents[number] >= 0:
            file.add(
                "NODE_SKINNED_MESH_NON_ROOT",
                place,
                "its parents do not move a skinned mesh",
            )
        if (
            _is_moved(node)
            and file.get("skins", node.get("skin")) is not None
            and file.get("meshes", node.get("mesh")) is not None
        ):
            file.add(
                "NODE_SKINNED_MESH_LOCAL_TRANSFORMS",
                place,
                "its own transform does not move a skinned mesh",
            )
    for number, scene in file.all("scenes"):
        for index, root in enumerate(list_of(scene, "nodes")):
            if is_node(root, parents) and parents[root] >= 0:
                file.add(
                    "SCENE_NON_ROOT_NODE",
                    ("scenes", number, "nodes", index),
                    f"nodes[{root}] has a parent",
                )
    return parents


def _parents(file: CheckedFile) -> list[int]:
    nodes = file.document.get("nodes")
    parents = [-1] * (len(nodes) if isinstance(nodes, list) else 0)
    for number, node in file.all("nodes"):
        for index, child in enumerate(list_of(node, "children")):
            if not is_node(child, parents):
                continue
            if parents[child] >= 0:
                file.add(
                    "NODE_PARENT_OVERRIDE",
                    ("nodes", number, "children", index),
                    f"nodes[{child}] has the parent nodes[{parents[child]}]",
                )
            parents[child] = number
    return parents


def _check_transform(
    file: CheckedFile, node: dict[str, Any], place: Place
) -> None:
    matrix = _numbers(node.get("matrix"), 16)
    if matrix is not None:
        where = (*place, "matrix")
        if any(name in node for name in _TRS):
            file.add(
                "NODE_MATRIX_TRS",
                where,
                "stands beside translation, rotation or scale",
            )
        if not _is_decomposable(matrix.reshape(4, 4).T):
            file.add(
                "NODE_MATRIX_NON_TRS",
                where,
                "is not translation, rotation and scale: it shears or projects",
            )
    rotation = _numbers(node.get("rotation"), 4)
    if rotation is not None:
        length = math.hypot(*rotation)
        if abs(length - 1) > _UNIT_ERROR:
            file.add(
                "ROTATION_NON_UNIT",
                (*place, "rotation"),
                f"has the length {length:.6g}",
            )


def _is_decomposable(matrix: Any) -> bool:
    """Whether the columns are orthogonal, not zero, and the last row affine."""
    if not np.array_equal(matrix[3], (0, 0, 0, 1)):
        return False
    columns = matrix[:3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.linalg.norm(columns, axis=0)
        if (length == 0).any():
            return False
        unit = columns / length
        return bool(np.abs(unit.T @ unit - np.eye(3)).max() < 5e-3)


def _is_moved(node: dict[str, Any]) -> bool:
    """Whether a transform of the node's own is not the identity."""
    for name, identity in _IDENTITIES.items():
        given = _numbers(node.get(name), len(identity))
        if given is not None and not np.array_equal(given, identity):
            return True
    return False


def _check_mesh(file: CheckedFile, node: dict[str, Any], place: Place) -> None:
    mesh = file.get("meshes", node.get("mesh"))
    if "skin" in node and (
        "mesh" not in node
        or not isinstance(node["mesh"], int)
        or node["mesh"] < 0
    ):
        file.add(
            "UNSATISFIED_DEPENDENCY", (*place, "skin"), "a skin needs a mesh"
        )
    if mesh is None:
        return
    primitives = [
        each for each in list_of(mesh, "primitives") if isinstance(each, dict)
    ]
    weights = node.get("weights")
    if isinstance(weights, list) and primitives:
        count = len(list_of(primitives[0], "targets"))
        if len(weights) != count:
            file.add(
                "NODE_WEIGHTS_INVALID",
                (*place, "weights"),
                f"has {len(weights)} elements for {count} morph targets",
            )
    skinned = [_is_skinned(each) for each in primitives]
    if "skin" in node and skinned and not all(skinned):
        file.add(
            "NODE_SKIN_WITH_NON_SKINNED_MESH",
            place,
            "its mesh has no joints and weights",
        )
    if "skin" not in node and any(skinned):
        file.add(
            "NODE_SKINNED_MESH_WITHOUT_SKIN",
            place,
            "its mesh has joints and weights that nothing moves",
        )


def _is_skinned(primitive: dict[str, Any]) -> bool:
    attributes = primitive.get("attributes")
    return (
        isinstance(attributes, dict)
        and {
            "JOINTS_0",
            "WEIGHTS_0",
        }
        <= attributes.keys()
    )


def _numbers(value: Any, count: int) -> Any:
    if (
        isinstance(value, list)
        and len(value) == count
        and all(isinstance(each, int | float) for each in value)
    ):
        return np.array([*map(float_of, value)])
    return None
