"""What a glTF file says, read with pygltflib, one thing after the other."""

import io
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray
from PIL import Image, ImageOps

from tests.support.oracles.keyframes import sample

__all__ = ["FileOracle", "elements"]

_TYPES = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4"}
_TYPES[5126] = "f4"
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_REST = {
    "translation": (0, 0, 0),
    "rotation": (0, 0, 0, 1),
    "scale": (1, 1, 1),
}


def elements(gltf: pygltflib.GLTF2, index: int) -> NDArray[Any]:
    """The rows (N, C) of an accessor, by pygltflib's own means."""
    accessor = gltf.accessors[index]
    view = gltf.bufferViews[accessor.bufferView]
    data = gltf.get_data_from_buffer_uri(gltf.buffers[view.buffer].uri)
    width = _WIDTHS[accessor.type]
    dtype = np.dtype(_TYPES[accessor.componentType])
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    stride = view.byteStride or width * dtype.itemsize
    array = np.ndarray(
        (accessor.count, width),
        dtype,
        data,
        start,
        (stride, dtype.itemsize),
    ).copy()
    if accessor.normalized:
        array = array / np.iinfo(dtype).max
    return array


class FileOracle:
    """A file's nodes at one moment, walked one by one."""

    def __init__(self, path: Path) -> None:
        loaded = pygltflib.GLTF2.load(str(path))
        assert loaded is not None
        self.path = path
        self.gltf: Any = loaded
        self.elements = cache(lambda index: elements(loaded, index))

    def moved(self, animation: Any, time: float) -> dict[Any, Any]:
        """What the channels move, by node and path."""
        values = {}
        for channel in animation.channels:
            sampler = animation.samplers[channel.sampler]
            times = self.elements(sampler.input)[:, 0].tolist()
            keys = self.elements(sampler.output)
            path = channel.target.path
            values[channel.target.node, path] = sample(
                times,
                keys.reshape(len(times), -1),
                sampler.interpolation,
                time,
                rotates=path == "rotation",
            )
        return values

    def local(self, index: int, moved: dict[Any, Any]) -> Any:
        """A node's matrix (4, 4) below its parent."""
        node = self.gltf.nodes[index]
        if node.matrix is not None:
            return np.reshape(node.matrix, (4, 4)).T
        translation, rotation, scale = (
            np.asarray(
                moved.get((index, name), getattr(node, name) or _REST[name]),
                np.float64,
            )
            for name in _REST
        )
        x, y, z, w = rotation / np.linalg.norm(rotation)
        cross = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
        matrix = np.eye(4)
        turn = np.eye(3) + 2 * w * cross + 2 * cross @ cross
        matrix[:3, :3] = turn @ np.diag(scale)
        matrix[:3, 3] = translation
        return matrix

    def world(self, moved: dict[Any, Any]) -> dict[int, Any]:
        """The matrix (4, 4) of every node of the default scene."""
        found: dict[int, Any] = {}

        def walk(index: int, above: Any) -> None:
            found[index] = above @ self.local(index, moved)
            for child in self.gltf.nodes[index].children:
                walk(child, found[index])

        for root in self.gltf.scenes[self.gltf.scene or 0].nodes:
            walk(root, np.eye(4))
        return found

    def image(self, index: int) -> NDArray[np.uint8]:
        """The texels (H, W, 4) of an image, decoded by Pillow."""
        image = self.gltf.images[index]
        if image.bufferView is None:
            data = (self.path.parent / image.uri).read_bytes()
        else:
            view = self.gltf.bufferViews[image.bufferView]
            start = view.byteOffset or 0
            data = self.gltf.get_data_from_buffer_uri(
                self.gltf.buffers[view.buffer].uri
            )[start : start + view.byteLength]
        opened = ImageOps.exif_transpose(Image.open(io.BytesIO(data)))
        return np.asarray(opened.convert("RGBA"))
