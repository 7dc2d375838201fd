"""The one buffer of a glTF file that is being written."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.core.maths import Array, column_major

if TYPE_CHECKING:
    import pygltflib

__all__ = ["BinaryWriter"]

_UNSIGNED_BYTE = 5121
_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125
_VERTICES, _INDICES = 34962, 34963  # targets of buffer views
_TYPES = {2: "VEC2", 3: "VEC3", 4: "VEC4"}
# 65535 would restart a strip of 16-bit indices.
_SHORT_LIMIT = 65535


class BinaryWriter:
    """Collects bytes, and the buffer views and accessors that name them.

    An array that is written twice is stored once; the arrays must stay
    alive as long as the writer.
    """

    def __init__(self, gltf: "pygltflib.GLTF2") -> None:
        self._gltf = gltf
        self._data = bytearray()
        self._accessors: dict[tuple[int, str], int] = {}

    def attribute(self, array: NDArray[np.float32], name: str) -> int:
        """The accessor of a float32 vertex attribute (N, C)."""
        key = id(array), name
        if key not in self._accessors:
            limits = {}
            if name == "POSITION":  # the one that must state its bounds
                limits = {
                    "min": array.min(axis=0).tolist(),
                    "max": array.max(axis=0).tolist(),
                }
            self._accessors[key] = self._accessor(
                np.ascontiguousarray(array, "<f4"),
                _VERTICES,
                componentType=_FLOAT,
                type=_TYPES[array.shape[1]],
                **limits,
            )
        return self._accessors[key]

    def indices(self, array: NDArray[np.uint32]) -> int:
        """The accessor of indices (M,), in 16 bits if they fit."""
        key = id(array), ""
        if key not in self._accessors:
            short = array.max() < _SHORT_LIMIT
            self._accessors[key] = self._accessor(
                array.astype("<u2" if short else "<u4"),
                _INDICES,
                componentType=_UNSIGNED_SHORT if short else _UNSIGNED_INT,
                type="SCALAR",
            )
        return self._accessors[key]

    def joints(self, array: NDArray[np.float32]) -> int:
        """The accessor of numbers of joints (N, 4), in 16 bits."""
        key = id(array), "JOINTS"
        if key not in self._accessors:
            self._accessors[key] = self._accessor(
                array.astype("<u2"),
                _VERTICES,
                componentType=_UNSIGNED_SHORT,
                type="VEC4",
            )
        return self._accessors[key]

    def times(self, array: NDArray[np.float32]) -> int:
        """The accessor of the times (K,) of keyframes, in increasing order."""
        key = id(array), "times"
        if key not in self._accessors:
            self._accessors[key] = self._accessor(
                np.ascontiguousarray(array, "<f4"),
                None,
                componentType=_FLOAT,
                type="SCALAR",
                min=[float(array[0])],
                max=[float(array[-1])],
            )
        return self._accessors[key]

    def values(self, array: NDArray[np.float32 | np.uint8]) -> int:
        """The accessor of numbers (N,) or vectors (N, C) of keyframes."""
        is_float = array.dtype.kind == "f"
        return self._accessor(
            np.ascontiguousarray(array, "<f4" if is_float else "u1"),
            None,
            componentType=_FLOAT if is_float else _UNSIGNED_BYTE,
            type="SCALAR" if array.ndim == 1 else _TYPES[array.shape[1]],
        )

    def matrices(self, array: Array) -> int:
        """The accessor of matrices (N, 4, 4), [row, column], as float32."""
        return self._accessor(
            column_major(array).astype("<f4"),
            None,
            componentType=_FLOAT,
            type="MAT4",
        )

    def view(self, data: bytes | memoryview, target: int | None = None) -> int:
        """The buffer view of ``data``, aligned to 4 bytes."""
        import pygltflib

        self._data += bytes(-len(self._data) % 4)
        self._gltf.bufferViews.append(
            pygltflib.BufferView(
                buffer=0,
                byteOffset=len(self._data),
                byteLength=len(data),
                target=target,
            )
        )
        self._data += data
        return len(self._gltf.bufferViews) - 1

    def finish(self) -> None:
        """Give the document its buffer; nothing can be added after it."""
        import pygltflib

        if not self._data:
            return
        self._data += bytes(-len(self._data) % 4)
        self._gltf.buffers = [pygltflib.Buffer(byteLength=len(self._data))]
        self._gltf.set_binary_blob(bytes(self._data))

    def _accessor(
        self, array: NDArray[Any], target: int | None, **properties: Any
    ) -> int:
        import pygltflib

        view = self.view(array.tobytes(), target)
        self._gltf.accessors.append(
            pygltflib.Accessor(bufferView=view, count=len(array), **properties)
        )
        return len(self._gltf.accessors) - 1
