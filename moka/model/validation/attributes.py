"""Vertex attributes: their names, sets, formats and values.

Source: glTF 2.0 specification, section 3.7.2.1 (attributes).
"""

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.model.validation.context import CheckedFile
from moka.model.validation.issues import Place

__all__ = ["SINGLE", "check_attribute", "check_sets"]

_BYTE, _UBYTE, _SHORT, _USHORT, _UINT, _FLOAT = (
    5120,
    5121,
    5122,
    5123,
    5125,
    5126,
)
_COLOUR = {(_FLOAT, False), (_UBYTE, True), (_USHORT, True)}
# Types, and component types with whether they are normalised.
_FORMATS: dict[str, tuple[set[str], set[tuple[int, bool]]]] = {
    "POSITION": ({"VEC3"}, {(_FLOAT, False)}),
    "NORMAL": ({"VEC3"}, {(_FLOAT, False)}),
    "TANGENT": ({"VEC4"}, {(_FLOAT, False)}),
    "TEXCOORD": ({"VEC2"}, _COLOUR),
    "COLOR": ({"VEC3", "VEC4"}, _COLOUR),
    "JOINTS": ({"VEC4"}, {(_UBYTE, False), (_USHORT, False)}),
    "WEIGHTS": ({"VEC4"}, _COLOUR),
}
_NARROW = {_BYTE, _UBYTE, _SHORT, _USHORT}
# KHR_mesh_quantization.
_QUANTISED = {
    "POSITION": {(each, flag) for each in _NARROW for flag in (False, True)},
    "NORMAL": {(_BYTE, True), (_SHORT, True)},
    "TANGENT": {(_BYTE, True), (_SHORT, True)},
    "TEXCOORD": {(each, flag) for each in _NARROW for flag in (False, True)},
}
SINGLE = ("POSITION", "NORMAL", "TANGENT")
_SETS = ("TEXCOORD", "COLOR", "JOINTS", "WEIGHTS")
_INDEXED = re.compile(r"(TEXCOORD|COLOR|JOINTS|WEIGHTS)_(0|[1-9][0-9]*)")
# As generous as the Khronos validator is: for unit vectors of any storage.
_UNIT_ERROR = 0.00769
_VERTEX_BUFFER = 34962


def check_sets(
    file: CheckedFile, attributes: dict[str, Any], place: Place
) -> None:
    """Numbers of sets are 0, 1, 2 …; joints have weights."""
    sets: dict[str, set[int]] = {name: set() for name in _SETS}
    for name in attributes:
        match = _INDEXED.fullmatch(name)
        if match:
            sets[match[1]].add(int(match[2]))
    for name, numbers in sets.items():
        if numbers != set(range(len(numbers))):
            file.add(
                "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
                place,
                f"sets of {name} must be numbered from 0 without gaps",
            )
    joints, weights = len(sets["JOINTS"]), len(sets["WEIGHTS"])
    if joints != weights:
        file.add(
            "MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH",
            place,
            f"{joints} sets of JOINTS and {weights} of WEIGHTS",
        )


def check_attribute(
    file: CheckedFile, name: str, accessor: Any, place: Place, *, base: bool
) -> None:
    match = _INDEXED.fullmatch(name)
    semantic = match[1] if match else name
    if semantic not in _FORMATS or (semantic in _SETS and not match):
        if not name.startswith("_"):
            file.add(
                "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
                place,
                "is no attribute of glTF; others begin with _",
            )
        return
    layout = file.format_of(accessor)
    found = file.get("accessors", accessor)
    if layout is None or found is None:
        return
    file.check_target(accessor, _VERTEX_BUFFER, place)
    file.use(accessor, "vertices", place)
    if semantic == "POSITION" and not ("min" in found and "max" in found):
        file.add(
            "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
            place,
            "the accessor of POSITION needs min and max",
        )
    types, components = _FORMATS[semantic]
    if semantic == "TANGENT" and not base:
        types = {"VEC3"}  # A morph target does not move the sign.
    used = file.document.get("extensionsUsed")
    if isinstance(used, list) and "KHR_mesh_quantization" in used:
        components = components | _QUANTISED.get(semantic, set())
    kind, component, normalised = layout
    if kind not in types or (component, normalised) not in components:
        file.add(
            "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
            place,
            f"accessors[{accessor}] is {kind} of component type {component}"
            f"{', normalised' if normalised else ''}",
        )
        return
    array = file.array_of(accessor)
    if array is not None and component == _FLOAT and base:
        _check_values(file, semantic, array, place)


def _check_values(
    file: CheckedFile, semantic: str, array: NDArray[Any], place: Place
) -> None:
    """Unit vectors, signs, colours within 0..1, weights that are shares."""
    if not np.isfinite(array).all():
        return  # Told of the accessor.
    if semantic in ("NORMAL", "TANGENT"):
        length = np.linalg.norm(array[:, :3].astype(np.float64), axis=1)
        _note(
            file,
            "ACCESSOR_VECTOR3_NON_UNIT",
            place,
            np.asarray(np.abs(length - 1) > _UNIT_ERROR),
            length,
            "has the length {}",
        )
    if semantic == "TANGENT":
        sign = array[:, 3]
        _note(
            file,
            "ACCESSOR_INVALID_SIGN",
            place,
            np.asarray(np.abs(sign) != 1),
            sign,
            "has the sign {}, not 1 or -1",
        )
    if semantic == "COLOR":
        beyond = np.asarray(((array < 0) | (array > 1)).any(axis=1))
        _note(
            file,
            "ACCESSOR_NON_CLAMPED",
            place,
            beyond,
            array.max(axis=1),
            "is not within 0..1",
        )


def _note(
    file: CheckedFile,
    code: str,
    place: Place,
    wrong: NDArray[np.bool_],
    values: NDArray[Any],
    text: str,
) -> None:
    """One issue for the elements that are ``wrong`` (N,), if any are."""
    rows = np.flatnonzero(wrong)
    if len(rows):
        first = int(rows[0])
        more = f", and {len(rows) - 1} more" if len(rows) > 1 else ""
        what = text.format(f"{values[first]:.6g}")
        file.add(code, place, f"element {first} {what}{more}")
