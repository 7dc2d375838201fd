"""glTF files made by hand, whole and broken ones."""

import copy
import json
import struct
from typing import Any

import numpy as np

Document = dict[str, Any]

TRIANGLE_POSITIONS = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0)], "<f4")
TRIANGLE_INDICES = np.array([0, 1, 2], "<u2")
TRIANGLE_BINARY = TRIANGLE_POSITIONS.tobytes() + TRIANGLE_INDICES.tobytes()

TRIANGLE: Document = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "name": "node"}],
    "meshes": [
        {
            "name": "triangle",
            "primitives": [
                {"attributes": {"POSITION": 0}, "indices": 1, "material": 0}
            ],
        }
    ],
    "materials": [{"name": "plain"}],
    "accessors": [
        {
            "bufferView": 0,
            "componentType": 5126,
            "count": 3,
            "type": "VEC3",
            "min": [0, 0, 0],
            "max": [1, 2, 0],
        },
        {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
    ],
    "bufferViews": [
        {"buffer": 0, "byteLength": 36},
        {"buffer": 0, "byteOffset": 36, "byteLength": 6},
    ],
    "buffers": [{"byteLength": 42}],
}


def triangle(**changes: Any) -> Document:
    """The document of one triangle with top-level properties replaced."""
    return {**copy.deepcopy(TRIANGLE), **changes}


def changed(path: str, value: Any, document: Document = TRIANGLE) -> Document:
    """A copy of ``document`` with what is at ``path`` set to ``value``.

    ``path`` is a JSON path like ``meshes[0].name``; the last step may be
    new, also one element behind the end of a list.
    """
    result = copy.deepcopy(document)
    steps: list[str | int] = []
    for name in path.split("."):
        key, *indices = name.replace("]", "").split("[")
        steps += [key, *map(int, indices)]
    place: Any = result
    for step in steps[:-1]:
        place = place[step]
    last = steps[-1]
    if isinstance(place, list) and last == len(place):
        place.append(value)
    else:
        place[last] = value
    return result


def glb(document: Document, binary: bytes | None = TRIANGLE_BINARY) -> bytes:
    """A .glb of ``document`` and, unless it is None, a binary chunk."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if binary is not None:
        binary += bytes(-len(binary) % 4)
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def mesh_document(
    arrays: dict[str, np.ndarray[Any, Any]],
    indices: np.ndarray[Any, Any] | None = None,
    **primitive: Any,
) -> tuple[Document, bytes]:
    """A document with one primitive of ``arrays``, and its binary chunk.

    The accessors take their types from the arrays; those of unsigned
    integers other than indices are normalised.
    """
    document = triangle(materials=[], accessors=[], bufferViews=[])
    codes = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125}
    codes["f4"] = 5126
    binary = b""

    def add(array: np.ndarray[Any, Any], normalized: bool) -> int:
        nonlocal binary
        binary += bytes(-len(binary) % 4)
        width = array.shape[1] if array.ndim == 2 else 1
        document["bufferViews"].append(
            {
                "buffer": 0,
                "byteOffset": len(binary),
                "byteLength": array.nbytes,
            }
        )
        document["accessors"].append(
            {
                "bufferView": len(document["bufferViews"]) - 1,
                "componentType": codes[array.dtype.str[1:]],
                "count": len(array),
                "type": "SCALAR" if width == 1 else f"VEC{width}",
                "normalized": normalized,
            }
        )
        binary += array.tobytes()
        return len(document["accessors"]) - 1

    attributes = {
        name: add(array, array.dtype.kind == "u")
        for name, array in arrays.items()
    }
    made = {"attributes": attributes, **primitive}
    if indices is not None:
        made["indices"] = add(indices, False)
    document["meshes"][0]["primitives"] = [made]
    document["buffers"] = [{"byteLength": len(binary)}]
    return document, binary
