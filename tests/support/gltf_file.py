"""glTF files built from arrays: a document and the one buffer of it."""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from moka.model.geometry import quad

__all__ = ["GltfFile"]

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125}


class GltfFile:
    """Collects arrays; ``document`` may be changed at will."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "accessors": [],
            "bufferViews": [],
            "meshes": [],
            "materials": [],
            "nodes": [],
        }

    def accessor(
        self,
        array: ArrayLike,
        dtype: str = "f4",
        *,
        normalized: bool = False,
        limits: bool = False,
    ) -> int:
        """The number of an accessor of (N,) or (N, C) numbers."""
        values = np.ascontiguousarray(array, "<" + dtype)
        self.binary += bytes(-len(self.binary) % 4)
        self.document["bufferViews"].append(
            {
                "buffer": 0,
                "byteOffset": len(self.binary),
                "byteLength": values.nbytes,
            }
        )
        self.binary += values.tobytes()
        width = 1 if values.ndim == 1 else values.shape[1]
        accessor: dict[str, Any] = {
            "bufferView": len(self.document["bufferViews"]) - 1,
            "componentType": _COMPONENTS.get(dtype, 5126),
            "count": len(values),
            "type": _TYPES[width],
        }
        if normalized:
            accessor["normalized"] = True
        if limits:
            accessor["min"] = np.atleast_1d(values.min(axis=0)).tolist()
            accessor["max"] = np.atleast_1d(values.max(axis=0)).tolist()
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def mesh(
        self,
        attributes: dict[str, ArrayLike],
        indices: ArrayLike | None = None,
        **primitive: Any,
    ) -> int:
        """The number of a mesh of one primitive."""
        made: dict[str, Any] = {
            "attributes": {
                name: self.accessor(array, limits=name == "POSITION")
                for name, array in attributes.items()
            },
            **primitive,
        }
        if indices is not None:
            made["indices"] = self.accessor(indices, "u4")
        self.document["meshes"].append({"primitives": [made]})
        return len(self.document["meshes"]) - 1

    def quad(self, size: float = 1.0, **primitive: Any) -> int:
        """The number of a mesh that is a square facing +Z."""
        made = quad(size)
        return self.mesh(made.attributes, made.indices, **primitive)

    def unlit(self, *rgba: float, **fields: Any) -> int:
        """The number of a material of one radiance."""
        self.document["materials"].append(
            {
                "pbrMetallicRoughness": {"baseColorFactor": list(rgba)},
                "extensions": {"KHR_materials_unlit": {}},
                **fields,
            }
        )
        return len(self.document["materials"]) - 1

    def node(self, **fields: Any) -> int:
        """The number of a node."""
        self.document["nodes"].append(fields)
        return len(self.document["nodes"]) - 1

    def glb(self) -> bytes:
        """The bytes of the file."""
        self.binary += bytes(-len(self.binary) % 4)
        document = {key: value for key, value in self.document.items() if value}
        if used := _extensions(document):
            document["extensionsUsed"] = sorted(used)
        if self.binary:
            document["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self.binary), b"BIN\0")
        chunks += self.binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _extensions(value: Any) -> set[str]:
    """The names of all extensions below ``value``."""
    if isinstance(value, list):
        return set().union(*map(_extensions, value))
    if not isinstance(value, dict):
        return set()
    own = set(value.get("extensions", ()))
    return own.union(*map(_extensions, value.values()))
