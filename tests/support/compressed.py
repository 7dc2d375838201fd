"""The same glTF file with its geometry compressed by the decoders' packages."""

import copy
import json
import struct
from pathlib import Path
from typing import Any

import DracoPy
import meshopt
import numpy as np

from moka.model.accessors import AccessorReader
from moka.model.source import GltfSource, open_source
from tests.model.files import Document, glb

DRACO = "KHR_draco_mesh_compression"
MESHOPT = "EXT_meshopt_compression"
DRACO_BITS = 14


def document_of(path: Path) -> tuple[Document, GltfSource]:
    """The JSON of a .glb or .gltf, and moka's reader of it."""
    data = path.read_bytes()
    if data[:4] == b"glTF":
        (size,) = struct.unpack_from("<I", data, 12)
        data = data[20 : 20 + size]
    return json.loads(data), open_source(path)


def with_meshopt(path: Path) -> bytes:
    """A .glb whose views of vertices and indices are compressed, exactly."""
    document, source = document_of(path)
    document = copy.deepcopy(document)
    indices = {
        primitive["indices"]: None
        for mesh in document["meshes"]
        for primitive in mesh["primitives"]
        if "indices" in primitive
    }
    reader = AccessorReader(source)
    binary = b""
    # Indices move to views of their own, which the codec is for.
    for index in indices:
        accessor = document["accessors"][index]
        array = reader.indices(index).astype("<u4")
        data = meshopt.encode_gltf_buffer(array, "TRIANGLES")
        document["bufferViews"].append(
            _view(len(binary), data, 4, len(array), "TRIANGLES")
        )
        binary += data + bytes(-len(data) % 4)
        accessor["bufferView"] = len(document["bufferViews"]) - 1
        accessor["componentType"] = 5125
        accessor.pop("byteOffset", None)
    for number, view in enumerate(document["bufferViews"]):
        if "extensions" in view:
            continue
        plain = bytes(source.view(number))
        stride = view.get("byteStride") or _stride(document, number)
        if stride is None or stride % 4 or len(plain) % stride:
            data, made = plain, {"byteLength": len(plain)}
        else:
            rows = np.frombuffer(plain, np.uint8).reshape(-1, stride)
            data = meshopt.encode_gltf_buffer(rows, "ATTRIBUTES")
            made = _view(len(binary), data, stride, len(rows), "ATTRIBUTES")
        made.setdefault("byteOffset", len(binary))
        made.setdefault("buffer", 0)
        if "byteStride" in view:
            made["byteStride"] = view["byteStride"]
        view.clear()
        view.update(made)
        binary += data + bytes(-len(data) % 4)
    plain_size = max(view["byteLength"] for view in document["bufferViews"])
    return _finish(
        document,
        path,
        binary,
        MESHOPT,
        {"byteLength": plain_size, "extensions": {MESHOPT: {"fallback": True}}},
    )


def with_draco(path: Path, *, fallback: bool = False) -> bytes:
    """A .glb whose primitives are compressed; positions to 14 bits.

    With ``fallback`` their accessors keep their buffer views.
    """
    document, source = document_of(path)
    reader = AccessorReader(source)
    binary = b""
    views = []
    for view in range(len(document["bufferViews"])):
        data = bytes(source.view(view))
        views.append({**document["bufferViews"][view], "buffer": 0})
        views[-1]["byteOffset"] = len(binary)
        binary += data + bytes(-len(data) % 4)
    document["bufferViews"] = views
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            arrays = {
                name: reader.array(index)
                for name, index in primitive["attributes"].items()
            }
            faces = reader.indices(primitive["indices"]).reshape(-1, 3)
            data, ids = encode_draco(arrays, faces)
            views.append(
                {
                    "buffer": 0,
                    "byteOffset": len(binary),
                    "byteLength": len(data),
                }
            )
            binary += data + bytes(-len(data) % 4)
            primitive["extensions"] = {
                DRACO: {"bufferView": len(views) - 1, "attributes": ids}
            }
            if not fallback:
                for index in (
                    *primitive["attributes"].values(),
                    primitive["indices"],
                ):
                    document["accessors"][index].pop("bufferView", None)
                    document["accessors"][index].pop("byteOffset", None)
    return _finish(document, path, binary, DRACO, required=not fallback)


def encode_draco(
    arrays: dict[str, np.ndarray[Any, Any]],
    faces: np.ndarray[Any, Any],
    **options: Any,
) -> tuple[bytes, dict[str, int]]:
    """Draco data of a mesh in its own order, and the ids of attributes."""
    others = [name for name in arrays if name != "POSITION"]
    data = DracoPy.encode(
        np.ascontiguousarray(arrays["POSITION"], np.float32),
        np.ascontiguousarray(faces, np.uint32),
        quantization_bits=DRACO_BITS,
        preserve_order=True,
        generic_attributes={
            number: np.ascontiguousarray(arrays[name])
            for number, name in enumerate(others)
        },
        **options,
    )
    ids = {name: number for number, name in enumerate(others)}
    # Positions get the next one.
    return data, {**ids, "POSITION": len(others)}


def _view(
    start: int, data: bytes, stride: int, count: int, mode: str
) -> dict[str, Any]:
    return {
        "buffer": 1,
        "byteOffset": 0,
        "byteLength": stride * count,
        "extensions": {
            MESHOPT: {
                "buffer": 0,
                "byteOffset": start,
                "byteLength": len(data),
                "byteStride": stride,
                "count": count,
                "mode": mode,
            }
        },
    }


def _stride(document: Document, view: int) -> int | None:
    """Bytes of an element of the one accessor that reads a view."""
    readers = [
        accessor
        for accessor in document["accessors"]
        if accessor.get("bufferView") == view
    ]
    if len(readers) != 1:
        return None
    widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
    sizes = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
    (reader,) = readers
    return widths[reader["type"]] * sizes[reader["componentType"]]


def _finish(
    document: Document,
    path: Path,
    binary: bytes,
    name: str,
    *buffers: dict[str, Any],
    required: bool = True,
) -> bytes:
    for image in document.get("images", ()):
        if "uri" in image and not image["uri"].startswith("data:"):
            data = (path.parent / image.pop("uri")).read_bytes()
            document["bufferViews"].append(
                {
                    "buffer": 0,
                    "byteOffset": len(binary),
                    "byteLength": len(data),
                }
            )
            image["bufferView"] = len(document["bufferViews"]) - 1
            image["mimeType"] = "image/png"
            binary += data + bytes(-len(data) % 4)
    document["buffers"] = [{"byteLength": len(binary)}, *buffers]
    document.setdefault("extensionsUsed", []).append(name)
    if required:
        document.setdefault("extensionsRequired", []).append(name)
    return glb(document, binary)
