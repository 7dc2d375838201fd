"""A file with everything in it, and each way in which one may be broken."""

import base64
import copy
import json
import struct
from collections.abc import Callable
from typing import Any

import numpy as np

from moka.core.png import encode_png

__all__ = ["FAULTS", "whole"]

Document = dict[str, Any]
Fault = Callable[[Document, bytearray], bytes | None]


def _scene() -> tuple[Document, bytearray]:
    """A document that breaks no rule, and its binary chunk."""
    binary = bytearray()
    views: list[Document] = []
    accessors: list[Document] = []

    def accessor(
        array: Any,
        dtype: str,
        kind: str,
        target: int | None = None,
        **more: Any,
    ) -> int:
        values = np.ascontiguousarray(array, dtype)
        views.append(
            {
                "buffer": 0,
                "byteOffset": len(binary),
                "byteLength": values.nbytes,
                **({"target": target} if target else {}),
            }
        )
        binary.extend(values.tobytes())
        binary.extend(bytes(-len(binary) % 4))
        component = {"f4": 5126, "u2": 5123, "u1": 5121, "i1": 5120}
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": component[values.dtype.str[1:]],
                "count": len(values),
                "type": kind,
                **more,
            }
        )
        return len(accessors) - 1

    vertex = 34962
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    position = accessor(
        corners, "<f4", "VEC3", vertex, min=[0, 0, 0], max=[1, 1, 0]
    )
    normal = accessor([(0, 0, 1)] * 4, "<f4", "VEC3", vertex)
    tangent = accessor([(1, 0, 0, 1)] * 4, "<f4", "VEC4", vertex)
    uv = accessor([(0, 1), (1, 1), (1, 0), (0, 0)], "<f4", "VEC2", vertex)
    colour = accessor([(1, 0.5, 0, 1)] * 4, "<f4", "VEC4", vertex)
    indices = accessor([0, 1, 2, 0, 2, 3], "<u2", "SCALAR", 34963)
    moved = accessor(
        [(0, 0, 1)] * 4, "<f4", "VEC3", vertex, min=[0, 0, 1], max=[0, 0, 1]
    )
    joints = accessor([(0, 1, 0, 0)] * 4, "<u1", "VEC4", vertex)
    weights = accessor([(0.5, 0.5, 0, 0)] * 4, "<f4", "VEC4", vertex)
    inverse = accessor([np.eye(4).reshape(-1)] * 2, "<f4", "MAT4")
    times = accessor([0, 1], "<f4", "SCALAR", min=[0], max=[1])
    turns = accessor([(0, 0, 0, 1), (0, 0, 0.6, 0.8)], "<f4", "VEC4")
    amounts = accessor([0, 1], "<f4", "SCALAR")
    views.append(
        {
            "buffer": 0,
            "byteOffset": len(binary),
            "byteLength": 0,
        }
    )
    picture = encode_png(np.full((4, 4, 3), 128, np.uint8))
    views[-1]["byteLength"] = len(picture)
    binary.extend(picture)
    binary.extend(bytes(-len(binary) % 4))
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 5]}],
        "nodes": [
            {"mesh": 0, "skin": 0, "name": "skinned"},
            {"children": [2], "name": "root"},
            {"children": [3], "translation": [0, 1, 0]},
            {"rotation": [0, 0, 0.6, 0.8], "children": [4]},
            {"camera": 0, "scale": [1, 1, 1]},
            {"mesh": 1, "name": "plain"},
        ],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {
                            "POSITION": position,
                            "NORMAL": normal,
                            "TANGENT": tangent,
                            "TEXCOORD_0": uv,
                            "COLOR_0": colour,
                            "JOINTS_0": joints,
                            "WEIGHTS_0": weights,
                        },
                        "indices": indices,
                        "material": 0,
                        "targets": [{"POSITION": moved}],
                    }
                ],
                "weights": [0.25],
            },
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": position},
                        "indices": indices,
                    }
                ]
            },
        ],
        "skins": [{"joints": [2, 3], "inverseBindMatrices": inverse}],
        "animations": [
            {
                "samplers": [
                    {"input": times, "output": turns},
                    {"input": times, "output": amounts},
                ],
                "channels": [
                    {
                        "sampler": 0,
                        "target": {"node": 3, "path": "rotation"},
                    },
                    {
                        "sampler": 1,
                        "target": {"node": 0, "path": "weights"},
                    },
                ],
            }
        ],
        "cameras": [
            {
                "type": "perspective",
                "perspective": {"yfov": 1.0, "znear": 0.1, "zfar": 10.0},
            }
        ],
        "materials": [
            {
                "pbrMetallicRoughness": {
                    "baseColorTexture": {"index": 0},
                    "roughnessFactor": 0.5,
                },
                "normalTexture": {"index": 0},
            }
        ],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9729, "wrapS": 33071}],
        "images": [{"bufferView": len(views) - 1, "mimeType": "image/png"}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    return document, binary


def whole(fault: Fault | None = None) -> bytes:
    """The bytes of a .glb, whole or with one fault."""
    document, binary = _scene()
    document = copy.deepcopy(document)
    if fault is not None:
        made = fault(document, binary)
        if made is not None:
            return made
    return glb(json.dumps(document).encode(), bytes(binary))


def glb(text: bytes, binary: bytes | None) -> bytes:
    """A container of a JSON text and, unless it is None, a binary chunk."""
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if binary is not None:
        binary += bytes(-len(binary) % 4)
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _set(path: str, value: Any) -> Fault:
    """Put ``value`` at a path such as ``nodes.0.mesh``."""

    def change(document: Document, _binary: bytearray) -> None:
        *steps, last = path.split(".")
        place: Any = document
        for step in steps:
            place = place[int(step) if isinstance(place, list) else step]
        if isinstance(place, list):
            place[int(last) :] = [value, *place[int(last) + 1 :]]
        else:
            place[last] = value

    return change


def _drop(path: str) -> Fault:
    """Take away what is at a path."""

    def change(document: Document, _binary: bytearray) -> None:
        *steps, last = path.split(".")
        place: Any = document
        for step in steps:
            place = place[int(step) if isinstance(place, list) else step]
        del place[int(last) if isinstance(place, list) else last]

    return change


def _write(accessor: int, offset: int, value: Any, dtype: str) -> Fault:
    """Overwrite data ``offset`` bytes behind an accessor's start."""

    def change(document: Document, binary: bytearray) -> None:
        view = document["accessors"][accessor]["bufferView"]
        start = document["bufferViews"][view]["byteOffset"] + offset
        data = np.asarray(value, dtype).tobytes()
        binary[start : start + len(data)] = data

    return change


def _all(*faults: Fault) -> Fault:
    def change(document: Document, binary: bytearray) -> None:
        for fault in faults:
            fault(document, binary)

    return change


def _bytes(make: Callable[[bytes], bytes]) -> Fault:
    """Break the finished container."""

    def change(document: Document, binary: bytearray) -> bytes:
        return make(glb(json.dumps(document).encode(), bytes(binary)))

    return change


def _text(make: Callable[[str], str]) -> Fault:
    """Break the JSON text."""

    def change(document: Document, binary: bytearray) -> bytes:
        return glb(make(json.dumps(document)).encode(), bytes(binary))

    return change


def _word(offset: int, value: int) -> Fault:
    return _bytes(
        lambda data: (
            data[:offset] + struct.pack("<I", value) + data[offset + 4 :]
        )
    )


def _chunk(kind: bytes, data: bytes) -> Fault:
    """Append a chunk."""

    def make(whole: bytes) -> bytes:
        whole += struct.pack("<I4s", len(data), kind) + data
        return whole[:8] + struct.pack("<I", len(whole)) + whole[12:]

    return _bytes(make)


_POSITION, _NORMAL, _TANGENT, _UV, _COLOUR, _INDICES = range(6)
_MOVED, _JOINTS, _WEIGHTS, _INVERSE, _TIMES, _TURNS, _AMOUNTS = range(6, 13)
_FIRST = "meshes.0.primitives.0"
_PNG = base64.b64encode(encode_png(np.zeros((1, 1, 3), np.uint8))).decode()
_SPARSE = {
    "count": 1,
    "indices": {"bufferView": 5, "componentType": 5123},
    "values": {"bufferView": 1},
}

FAULTS: dict[str, Fault] = {
    # Container.
    "version of the container": _word(4, 1),
    "length of the container": _word(8, 60),
    "length beyond the file": _word(8, 100_000),
    "length of a chunk": _word(12, 100_000),
    "first chunk is not JSON": _word(16, 0x004E4942),
    "extra data": _bytes(lambda data: data + b"\0\0\0\0"),
    "unknown chunk": _chunk(b"MOKA", b"\0\0\0\0"),
    "second binary chunk": _chunk(b"BIN\0", b"\0\0\0\0"),
    "header cut off": _bytes(lambda data: data[:10]),
    "chunk header cut off": _bytes(
        lambda data: (
            data[:8]
            + struct.pack("<I", len(data) + 4)
            + data[12:]
            + b"\0\0\0\0"
        )
    ),
    "no binary chunk": _bytes(
        lambda data: glb(
            data[20 : 20 + struct.unpack_from("<I", data, 12)[0]], None
        )
    ),
    # JSON.
    "not JSON": _text(lambda text: text[:-2]),
    "not an object": _text(lambda _text: "[]"),
    "no asset": _drop("asset"),
    "no version": _drop("asset.version"),
    "version of another format": _set("asset.version", "3.0"),
    "version without a dot": _set("asset.version", "2"),
    "least version above the version": _set("asset.minVersion", "2.1"),
    "string for a number": _set("accessors.0.count", "4"),
    "number for a string": _set("nodes.0.name", 4),
    "object for a list": _set("meshes", {}),
    "number in a list of objects": _set("nodes.2", 5),
    "text in a list of numbers": _set("nodes.2.translation", [0, "a", 0]),
    "list of a wrong length": _set("nodes.2.translation", [0, 0]),
    "empty list": _set("nodes.1.children", []),
    "property without a meaning": _set("nodes.1.colour", 1),
    "negative index": _set("nodes.0.mesh", -1),
    "count of nothing": _set("accessors.0.count", 0),
    "negative factor": _set(
        "materials.0.pbrMetallicRoughness.metallicFactor", -0.5
    ),
    "unknown wrap mode": _set("samplers.0.wrapS", 7),
    "unknown component type": _set("accessors.0.componentType", 5127),
    "unknown alpha mode": _set("materials.0.alphaMode", "GLASS"),
    "no component type": _drop("accessors.0.componentType"),
    "no attributes": _drop(f"{_FIRST}.attributes"),
    "no primitives": _set("meshes.1.primitives", []),
    "same child twice": _set("nodes.1.children", [2, 2]),
    # References.
    "mesh out of range": _set("nodes.0.mesh", 9),
    "node out of range": _set("scenes.0.nodes", [0, 99]),
    "accessor out of range": _set(f"{_FIRST}.attributes.NORMAL", 77),
    "buffer view out of range": _set("accessors.0.bufferView", 77),
    "buffer out of range": _set("bufferViews.0.buffer", 3),
    "image out of range": _set("textures.0.source", 3),
    "texture out of range": _set("materials.0.normalTexture.index", 3),
    "scene out of range": _set("scene", 3),
    "joint out of range": _set("skins.0.joints", [2, 33]),
    "sampler of an animation out of range": _set(
        "animations.0.channels.0.sampler", 5
    ),
    # Buffers and accessors.
    "view beyond its buffer": _set("bufferViews.0.byteLength", 100_000),
    "buffer beyond its data": _set("buffers.0.byteLength", 100_000),
    "accessor beyond its view": _set("accessors.0.count", 5),
    "offset not aligned": _set("accessors.5.byteOffset", 1),
    "offset into no view": _all(
        _drop("accessors.2.bufferView"), _set("accessors.2.byteOffset", 0)
    ),
    "view not aligned": _set("bufferViews.5.byteOffset", 1),
    "stride below an element": _set("bufferViews.0.byteStride", 8),
    "stride beyond 252": _set("bufferViews.0.byteStride", 256),
    "stride of an odd size": _set("bufferViews.0.byteStride", 14),
    "stride of indices": _set("bufferViews.5.byteStride", 4),
    "vertices in a view of indices": _set("bufferViews.0.target", 34963),
    "normalised floats": _set("accessors.0.normalized", True),
    "least is wrong": _set("accessors.0.min", [0.5, 0, 0]),
    "greatest is wrong": _set("accessors.0.max", [2, 1, 0]),
    "no bounds of positions": _drop("accessors.0.min"),
    "bounds of a wrong length": _set("accessors.0.min", [0, 0]),
    "not a number": _write(_NORMAL, 0, np.nan, "<f4"),
    "infinite": _write(_UV, 0, np.inf, "<f4"),
    "sparse indices beyond": _all(
        _set("accessors.1.sparse", {**_SPARSE, "count": 1}),
        _write(_INDICES, 0, [9], "<u2"),
    ),
    "sparse indices that do not increase": _all(
        _set("accessors.1.sparse", {**_SPARSE, "count": 2}),
        _write(_INDICES, 0, [1, 1], "<u2"),
    ),
    "more sparse elements than elements": _set(
        "accessors.1.sparse", {**_SPARSE, "count": 5}
    ),
    # Meshes.
    "index beyond the vertices": _write(_INDICES, 0, 4, "<u2"),
    "index that restarts": _write(_INDICES, 2, 65535, "<u2"),
    "triangle without area": _write(_INDICES, 0, [0, 0, 0], "<u2"),
    "indices of a wrong number": _set("accessors.5.count", 5),
    "indices of a wrong type": _set(f"{_FIRST}.indices", _UV),
    "attribute of a wrong type": _set(f"{_FIRST}.attributes.NORMAL", _UV),
    "attributes of different counts": _set("accessors.1.count", 3),
    "no positions": _drop("meshes.1.primitives.0.attributes.POSITION"),
    "unknown attribute": _set(f"{_FIRST}.attributes.HEIGHT", _UV),
    "gap between sets": _set(f"{_FIRST}.attributes.TEXCOORD_2", _UV),
    "tangents without normals": _drop(f"{_FIRST}.attributes.NORMAL"),
    "normal that is not of length 1": _write(_NORMAL, 0, 2.0, "<f4"),
    "sign that is none": _write(_TANGENT, 12, 0.5, "<f4"),
    "tangent that is not of length 1": _write(_TANGENT, 0, 3.0, "<f4"),
    "colour beyond 1": _write(_COLOUR, 0, 1.5, "<f4"),
    "unknown mode": _set(f"{_FIRST}.mode", 9),
    "texture without coordinates": _set(
        "materials.0.normalTexture.texCoord", 3
    ),
    "texture on nothing": _drop(f"{_FIRST}.attributes.TEXCOORD_0"),
    # Morphs.
    "weights of another number": _set("meshes.0.weights", [0, 0]),
    "weights of a node of another number": _set("nodes.0.weights", [0, 0]),
    "target of an attribute that is not there": _all(
        _drop(f"{_FIRST}.attributes.COLOR_0"),
        _set(f"{_FIRST}.targets.0.COLOR_0", _COLOUR),
    ),
    "target of another count": _set("accessors.6.count", 3),
    # Skins.
    "joint beyond the skin": _write(_JOINTS, 0, 7, "<u1"),
    "negative weight": _write(_WEIGHTS, 0, [-0.5, 1.5], "<f4"),
    "weights that are not 1 together": _write(_WEIGHTS, 0, 0.1, "<f4"),
    "joint twice": _write(_JOINTS, 0, [1, 1], "<u1"),
    "joint without weight": _write(_JOINTS, 2, 1, "<u1"),
    "too few inverse matrices": _set("accessors.9.count", 1),
    "inverse matrices of a wrong type": _set(
        "skins.0.inverseBindMatrices", _TURNS
    ),
    "inverse matrix that is not affine": _write(_INVERSE, 60, 2.0, "<f4"),
    "skin of a mesh without joints": _set("nodes.5.skin", 0),
    "joints without weights": _drop(f"{_FIRST}.attributes.WEIGHTS_0"),
    "mesh with joints without a skin": _drop("nodes.0.skin"),
    "skinned mesh that its node moves": _set("nodes.0.scale", [2, 1, 1]),
    "joints without a common root": _set("skins.0.joints", [2, 5]),
    # Nodes.
    "node below itself": _set("nodes.4.children", [2]),
    "node with two parents": _set("nodes.5.children", [3]),
    "scene of a node with a parent": _set("scenes.0.nodes", [0, 2]),
    "matrix and rotation": _set("nodes.3.matrix", [1, 2] + [0] * 14),
    "matrix that is not a transform": _set(
        "nodes.4", {"matrix": [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}
    ),
    "rotation that is not of length 1": _set(
        "nodes.3.rotation", [0, 0, 0.5, 0.5]
    ),
    # Animations.
    "times that do not increase": _all(
        _write(_TIMES, 0, [1, 1], "<f4"), _set("accessors.10.min", [1])
    ),
    "negative time": _all(
        _write(_TIMES, 0, -1, "<f4"), _set("accessors.10.min", [-1])
    ),
    "times without bounds": _drop("accessors.10.min"),
    "outputs of another count": _set("accessors.11.count", 1),
    "outputs of a wrong type": _set("animations.0.samplers.0.output", _NORMAL),
    "inputs of a wrong type": _set("animations.0.samplers.0.input", _TURNS),
    "rotations that are not of length 1": _write(_TURNS, 0, 2.0, "<f4"),
    "target twice": _set(
        "animations.0.channels.1.target", {"node": 3, "path": "rotation"}
    ),
    "target with a matrix": _set(
        "nodes.3", {"matrix": np.eye(4).T.reshape(-1).tolist()}
    ),
    "weights of a mesh without morphs": _set(
        "animations.0.channels.1.target.node", 5
    ),
    "path that is none": _set("animations.0.channels.0.target.path", "colour"),
    # Cameras and materials.
    "no type of a camera": _drop("cameras.0.type"),
    "perspective without numbers": _drop("cameras.0.perspective"),
    "far before near": _set("cameras.0.perspective.zfar", 0.05),
    "field of view of nothing": _set("cameras.0.perspective.yfov", 0),
    "field of view of all": _set("cameras.0.perspective.yfov", 4.0),
    "magnification of nothing": _set(
        "cameras.0",
        {
            "type": "orthographic",
            "orthographic": {"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1},
        },
    ),
    "cutoff without a mask": _set("materials.0.alphaCutoff", 0.2),
    # Images.
    "image of another format": _set("images.0.mimeType", "image/jpeg"),
    "image of an unknown type": _set("images.0.mimeType", "image/gif"),
    "image without a type": _drop("images.0.mimeType"),
    "image of two sources": _set(
        "images.0.uri", "data:image/png;base64," + _PNG
    ),
    "image of no source": _set("images.0", {}),
    "image that is none": _set("images.0.bufferView", 0),
    "image that is cut off": _set("bufferViews.13.byteLength", 20),
    "image that is missing": _set("images.0", {"uri": "missing.png"}),
    # Extensions.
    "extension that is not declared": _set(
        "materials.0.extensions", {"KHR_materials_unlit": {}}
    ),
    "required extension that is not used": _set(
        "extensionsRequired", ["KHR_materials_unlit"]
    ),
    "spot without a cone": _all(
        _set("extensionsUsed", ["KHR_lights_punctual"]),
        _set(
            "extensions",
            {
                "KHR_lights_punctual": {
                    "lights": [
                        {
                            "type": "spot",
                            "spot": {
                                "innerConeAngle": 0.5,
                                "outerConeAngle": 0.5,
                            },
                        }
                    ]
                }
            },
        ),
        _set("nodes.1.extensions", {"KHR_lights_punctual": {"light": 0}}),
    ),
    "light out of range": _all(
        _set("extensionsUsed", ["KHR_lights_punctual"]),
        _set(
            "extensions",
            {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
        ),
        _set("nodes.1.extensions", {"KHR_lights_punctual": {"light": 4}}),
    ),
}
