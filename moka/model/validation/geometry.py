"""Primitives: attributes, indices, morph targets, what materials need.

Source: glTF 2.0 specification, section 3.7.2 (meshes).
"""

from typing import Any

import numpy as np

from moka.model.validation.attributes import (
    SINGLE,
    check_attribute,
    check_sets,
)
from moka.model.validation.context import CheckedFile
from moka.model.validation.issues import Place

__all__ = ["check_meshes"]

_UBYTE, _USHORT, _UINT = 5121, 5123, 5125
_RESTART = {_UBYTE: 0xFF, _USHORT: 0xFFFF, _UINT: 0xFFFFFFFF}
# How many vertices each mode needs at least, and in steps of how many.
_MODES = {0: (1, 1), 1: (2, 2), 2: (2, 1), 3: (2, 1)} | {
    4: (3, 3),
    5: (3, 1),
    6: (3, 1),
}
_INDEX_BUFFER = 34963
_TEXTURES = (
    ("pbrMetallicRoughness", "baseColorTexture"),
    ("pbrMetallicRoughness", "metallicRoughnessTexture"),
    ("normalTexture",),
    ("occlusionTexture",),
    ("emissiveTexture",),
)
# Of extensions, what needs tangents.
_TANGENT_TEXTURES = (
    ("KHR_materials_anisotropy", "anisotropyTexture"),
    ("KHR_materials_clearcoat", "clearcoatNormalTexture"),
)


def check_meshes(file: CheckedFile) -> None:
    """Check all meshes and their primitives."""
    for number, mesh in file.all("meshes"):
        primitives = mesh.get("primitives")
        if not isinstance(primitives, list):
            continue
        counts = []
        for index, primitive in enumerate(primitives):
            if isinstance(primitive, dict):
                _check_primitive(
                    file, primitive, ("meshes", number, "primitives", index)
                )
                targets = primitive.get("targets")
                counts.append(len(targets) if isinstance(targets, list) else 0)
        place = ("meshes", number)
        if len(set(counts)) > 1:
            file.add(
                "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT",
                (*place, "primitives"),
                "have different numbers of morph targets",
            )
        weights = mesh.get("weights")
        if isinstance(weights, list) and counts and len(weights) != counts[0]:
            file.add(
                "MESH_INVALID_WEIGHTS_COUNT",
                (*place, "weights"),
                f"has {len(weights)} elements for {counts[0]} morph targets",
            )


def _check_primitive(
    file: CheckedFile, primitive: dict[str, Any], place: Place
) -> None:
    given = primitive.get("attributes")
    attributes = given if isinstance(given, dict) else {}
    if isinstance(given, dict) and given and "POSITION" not in given:
        file.add(
            "MESH_PRIMITIVE_NO_POSITION",
            (*place, "attributes"),
            "nothing is drawn without POSITION",
        )
    if "TANGENT" in attributes and "NORMAL" not in attributes:
        file.add(
            "MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL",
            (*place, "attributes", "TANGENT"),
            "has no meaning without NORMAL",
        )
    check_sets(file, attributes, (*place, "attributes"))
    for name, accessor in attributes.items():
        check_attribute(
            file, name, accessor, (*place, "attributes", name), base=True
        )
    counts = {
        name: file.count_of(accessor) for name, accessor in attributes.items()
    }
    first = next(iter(counts.values()), 0)
    for name, count in counts.items():
        if count != first and count is not None and first is not None:
            file.add(
                "MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT",
                (*place, "attributes", name),
                f"has {count} elements, not {first}",
            )
    _check_indices(file, primitive, place, counts.get("POSITION", first))
    _check_targets(file, primitive, attributes, place)
    _check_material(file, primitive, attributes, place)


def _check_indices(
    file: CheckedFile,
    primitive: dict[str, Any],
    place: Place,
    vertex_count: int | None,
) -> None:
    mode = primitive.get("mode", 4)
    index = primitive.get("indices")
    accessor = file.get("accessors", index)
    count = vertex_count if accessor is None else file.count_of(index)
    if isinstance(mode, int) and mode in _MODES and count:
        least, step = _MODES[mode]
        if count < least or count % step:
            file.add(
                "MESH_PRIMITIVE_INCOMPATIBLE_MODE",
                place,
                f"{count} vertices or indices do not fit mode {mode}",
            )
    layout = file.format_of(index)
    if accessor is None or layout is None:
        return
    where = (*place, "indices")
    file.check_target(index, _INDEX_BUFFER, where)
    file.use(index, "indices", where)
    if file.has_stride(index):
        file.add(
            "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
            where,
            "the buffer view of indices must not have a stride",
        )
    kind, component, normalised = layout
    if kind != "SCALAR" or component not in _RESTART or normalised:
        file.add(
            "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
            where,
            f"accessors[{index}] is not of plain unsigned scalars",
        )
        return
    array = file.array_of(index)
    if array is None:
        return
    order = array[:, 0]
    if vertex_count is not None and order.max() >= vertex_count:
        first = int(np.flatnonzero(order >= vertex_count)[0])
        file.add(
            "ACCESSOR_INDEX_OOB",
            where,
            f"index {order[first]} at {first} is beyond the {vertex_count} "
            "vertices",
        )
    if order.max() == _RESTART[component]:
        first = int(np.argmax(order))
        file.add(
            "ACCESSOR_INDEX_PRIMITIVE_RESTART",
            where,
            f"index {order[first]} at {first} would restart the primitive",
        )
    if mode == 4 and len(order) % 3 == 0:
        corners = order.reshape(-1, 3)
        same = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
        if same.any():
            file.add(
                "ACCESSOR_INDEX_TRIANGLE_DEGENERATE",
                where,
                f"{np.count_nonzero(same)} of {len(corners)} triangles have "
                "no area",
            )


def _check_targets(
    file: CheckedFile,
    primitive: dict[str, Any],
    attributes: dict[str, Any],
    place: Place,
) -> None:
    targets = primitive.get("targets")
    if not isinstance(targets, list):
        return
    for number, target in enumerate(targets):
        if not isinstance(target, dict):
            continue
        for name, accessor in target.items():
            where = (*place, "targets", number, name)
            base = file.count_of(attributes.get(name))
            moved = file.count_of(accessor)
            if file.get("accessors", attributes.get(name)) is None:
                file.add(
                    "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
                    where,
                    "the primitive does not have this attribute",
                )
            elif None not in (base, moved) and base != moved:
                file.add(
                    "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
                    where,
                    f"has {moved} elements, the attribute has {base}",
                )
            if name in SINGLE:
                check_attribute(file, name, accessor, where, base=False)


def _check_material(
    file: CheckedFile,
    primitive: dict[str, Any],
    attributes: dict[str, Any],
    place: Place,
) -> None:
    """The coordinates and tangents that the textures need."""
    material = file.get("materials", primitive.get("material"))
    if material is None:
        return
    where = (*place, "material")
    present = {name for name in attributes if name.startswith("TEXCOORD_")}
    # A gap ends the sets that count.
    sets = len(present)
    if present != {f"TEXCOORD_{number}" for number in range(sets)}:
        sets = 0
    for steps in _TEXTURES:
        info: Any = material
        for step in steps:
            info = info.get(step) if isinstance(info, dict) else None
        if not isinstance(info, dict):
            continue
        number = info.get("texCoord", 0)
        transform = file.extension(info, "KHR_texture_transform")
        number = transform.get("texCoord", number)
        if isinstance(number, int) and number >= sets:
            file.add(
                "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",
                where,
                f"{steps[-1]} needs TEXCOORD_{number}",
            )
    has_tangents = {"NORMAL", "TANGENT"} <= attributes.keys()
    if has_tangents:
        return
    if isinstance(material.get("normalTexture"), dict):
        file.add(
            "MESH_PRIMITIVE_GENERATED_TANGENT_SPACE",
            where,
            "its normal map needs tangents, which are made at run time",
        )
    elif any(
        isinstance(file.extension(material, name).get(texture), dict)
        for name, texture in _TANGENT_TEXTURES
    ):
        file.add(
            "MESH_PRIMITIVE_NO_TANGENT_SPACE",
            where,
            "it needs tangents, and has no normal map to make them for",
        )
