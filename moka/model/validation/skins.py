"""Skins, and what vertices say of their joints.

Source: glTF 2.0 specification, section 3.7.3 (skins).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.model.validation.context import CheckedFile
from moka.model.validation.hierarchy import (
    is_node,
    list_of,
    on_loops,
    root_of,
)
from moka.model.validation.issues import Place

__all__ = ["check_skins"]

_FLOAT = 5126


def check_skins(file: CheckedFile, parents: list[int]) -> None:
    """Check all skins, and what vertices say of their joints."""
    loops = set(on_loops(parents))
    for number, skin in file.all("skins"):
        place = ("skins", number)
        joints = [j for j in list_of(skin, "joints") if is_node(j, parents)]
        if joints and not loops.intersection(joints):
            roots = {root_of(joint, parents) for joint in joints}
            if len(roots) > 1:
                file.add(
                    "SKIN_NO_COMMON_ROOT",
                    (*place, "joints"),
                    "have no ancestor in common",
                )
        _check_inverse(file, skin, place, len(list_of(skin, "joints")))
    for number, node in file.all("nodes"):
        own = file.get("skins", node.get("skin"))
        mesh = file.get("meshes", node.get("mesh"))
        if own is None or mesh is None:
            continue
        count = len(list_of(own, "joints"))
        for index, primitive in enumerate(list_of(mesh, "primitives")):
            if isinstance(primitive, dict):
                _check_influences(
                    file,
                    primitive,
                    ("meshes", node["mesh"], "primitives", index, "attributes"),
                    count,
                )
        if not loops:
            _check_scenes(file, own, parents, number)


def _check_inverse(
    file: CheckedFile, skin: dict[str, Any], place: Place, count: int
) -> None:
    index = skin.get("inverseBindMatrices")
    layout = file.format_of(index)
    if layout is None:
        return
    where = (*place, "inverseBindMatrices")
    file.use(index, "inverse bind matrices", where)
    if file.has_stride(index):
        file.add(
            "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE",
            where,
            "the buffer view of inverse bind matrices must not have a stride",
        )
    if layout != ("MAT4", _FLOAT, False):
        file.add("SKIN_IBM_INVALID_FORMAT", where, "is not of MAT4 of floats")
        return
    found = file.count_of(index)
    if found is not None and found < count:
        file.add(
            "INVALID_IBM_ACCESSOR_COUNT",
            where,
            f"has {found} matrices for {count} joints",
        )
    array = file.array_of(index)
    if array is None:
        return
    wrong = np.flatnonzero((array[:, 3::4] != (0, 0, 0, 1)).any(axis=1))
    if len(wrong):
        file.add(
            "ACCESSOR_INVALID_IBM",
            where,
            f"matrix {wrong[0]} does not end in the row 0, 0, 0, 1",
        )


def _check_influences(
    file: CheckedFile, primitive: dict[str, Any], place: Place, count: int
) -> None:
    """Joints exist and are named once, weights are shares of 1."""
    attributes = primitive.get("attributes")
    if not isinstance(attributes, dict):
        return
    joints: list[NDArray[Any]] = []
    weights: list[NDArray[np.float64]] = []
    while True:
        names = f"JOINTS_{len(joints)}", f"WEIGHTS_{len(joints)}"
        found = [file.array_of(attributes.get(name)) for name in names]
        if found[0] is None or found[1] is None:
            break
        if len(found[0]) != len(found[1]) or found[1].dtype.kind != "f":
            return
        joints.append(found[0])
        weights.append(found[1].astype(np.float64))
    if not joints:
        return
    joint, weight = np.hstack(joints), np.hstack(weights)
    for index in range(len(joints)):
        where = (*place, f"JOINTS_{index}")
        columns = slice(4 * index, 4 * index + 4)
        wrong = np.argwhere(joint[:, columns] >= count)
        if len(wrong):
            row, column = wrong[0]
            file.add(
                "ACCESSOR_JOINTS_INDEX_OOB",
                where,
                f"element {row} names joint {joint[row, 4 * index + column]} "
                f"of {count}",
            )
        idle = np.argwhere((weight[:, columns] == 0) & (joint[:, columns] > 0))
        if len(idle):
            file.add(
                "ACCESSOR_JOINTS_USED_ZERO_WEIGHT",
                where,
                f"element {idle[0][0]} names a joint without weight",
            )
        negative = np.argwhere(weight[:, columns] < 0)
        if len(negative):
            file.add(
                "ACCESSOR_WEIGHTS_NEGATIVE",
                (*place, f"WEIGHTS_{index}"),
                f"a weight of element {negative[0][0]} is negative",
            )
    counted = (weight > 0) & (joint < count)
    for column in range(1, joint.shape[1]):
        same = joint[:, :column] == joint[:, column : column + 1]
        again = counted[:, column] & (same & counted[:, :column]).any(axis=1)
        counted[again, column] = False
        if again.any():
            file.add(
                "ACCESSOR_JOINTS_INDEX_DUPLICATE",
                (*place, f"JOINTS_{column // 4}"),
                f"element {np.argmax(again)} names a joint twice",
            )
    total = np.where(counted, weight, 0).sum(axis=1)
    used_weights = np.count_nonzero(weight, axis=1)
    uneven = np.flatnonzero(np.abs(total - 1) > 2e-7 * used_weights)
    if len(uneven):
        file.add(
            "ACCESSOR_WEIGHTS_NON_NORMALIZED",
            (*place, "WEIGHTS_0"),
            f"the weights of element {uneven[0]} sum to {total[uneven[0]]:.6g}",
        )


def _check_scenes(
    file: CheckedFile, skin: dict[str, Any], parents: list[int], number: int
) -> None:
    """Where a skinned mesh is shown its joints are too."""
    joints = [j for j in list_of(skin, "joints") if is_node(j, parents)]
    own = root_of(number, parents)
    roots = {root_of(joint, parents) for joint in joints}
    for _, scene in file.all("scenes"):
        shown = {each for each in list_of(scene, "nodes") if type(each) is int}
        if own in shown and not roots <= shown:
            file.add(
                "NODE_SKIN_NO_SCENE",
                ("nodes", number),
                "is in a scene that its joints are not in",
            )
