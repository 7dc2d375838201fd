"""Accessors of glTF as NumPy arrays, without a copy where layout allows.

Every component type, vectors and matrices with their column padding,
interleaved and unaligned strides, sparse substitution, normalised integers.
All bounds are checked before anything is allocated.

Source: glTF 2.0 specification, section 3.6.2 (accessors), and
KHR_mesh_quantization (which types may stand for floats).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.model.schema import Accessor, Sparse
from moka.model.source import GltfSource

__all__ = ["COMPONENTS", "AccessorReader"]

# The types of components by their codes.
COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
_UNSIGNED_INT = 5125
_FLOAT = 5126
# Columns and rows of an element; vectors are matrices of one column.
_SHAPES: dict[str, tuple[int, int]] = {
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}
# Elements without a buffer view are zeros that no byte of the file backs;
# all of them together stay below this, or a file of 1 kB could ask for any
# amount of memory.
_MAX_UNBACKED_ELEMENTS = 1 << 22


class AccessorReader:
    """Reads the accessors of one file, each of them once."""

    def __init__(self, source: GltfSource) -> None:
        self._source = source
        self._arrays: dict[int, NDArray[Any]] = {}
        self._floats: dict[int, NDArray[np.float32]] = {}
        self._indices: dict[int, NDArray[np.uint32]] = {}
        self._unbacked_elements = 0

    def array(self, index: int) -> NDArray[Any]:
        """The elements as they are stored, read-only.

        Shape (N,) for scalars, (N, C) for vectors, (N, rows, columns) for
        matrices; little-endian components of the accessor's type. A view
        into the file unless the accessor is sparse or has no buffer view.
        Raises ModelError if the accessor reaches beyond its data.
        """
        array = self._arrays.get(index)
        if array is None:
            array = self._arrays[index] = self._read(index)
        return array

    def floats(self, index: int) -> NDArray[np.float32]:
        """The elements as float32, normalised integers in 0..1 or -1..1.

        A view into the file if they are stored as floats. Raises ModelError
        as :meth:`array`, and for normalised 32-bit integers.
        """
        floats = self._floats.get(index)
        if floats is None:
            floats = self._floats[index] = self._convert(index)
        return floats

    def indices(self, index: int) -> NDArray[np.uint32]:
        """The elements (N,) of an accessor of vertex indices, as uint32.

        Raises ModelError as :meth:`array`, and unless they are plain
        unsigned scalars.
        """
        indices = self._indices.get(index)
        if indices is None:
            array = self.array(index)
            accessor = self._source.document.accessors[index]
            if (
                accessor.type != "SCALAR"
                or array.dtype.kind != "u"
                or accessor.normalized
            ):
                raise self._source.error(
                    f"accessors[{index}]",
                    "holds indices, which must be plain unsigned scalars",
                )
            indices = self._indices[index] = array.astype(np.uint32, copy=False)
        return indices

    def _convert(self, index: int) -> NDArray[np.float32]:
        array = self.array(index)
        accessor = self._source.document.accessors[index]
        if accessor.component_type == _FLOAT:
            return array.astype(np.float32, copy=False)
        floats = array.astype(np.float32)
        if accessor.normalized:
            if accessor.component_type == _UNSIGNED_INT:
                raise self._source.error(
                    f"accessors[{index}].normalized",
                    "is only defined for integers of 8 and 16 bits",
                )
            # Section 3.11: c / 127 and so on, the lowest integer clamped.
            floats /= np.float32(np.iinfo(array.dtype).max)
            if array.dtype.kind == "i":
                np.maximum(floats, -1.0, out=floats)
        floats.flags.writeable = False
        return floats

    def _read(self, index: int) -> NDArray[Any]:
        path = f"accessors[{index}]"
        accessors = self._source.document.accessors
        self._source.check_index(path, index, "accessors", len(accessors))
        accessor = accessors[index]
        if accessor.count == 0:
            raise self._source.error(f"{path}.count", "must be at least 1")
        if accessor.buffer_view is None:
            array = self._zeros(path, accessor)
        else:
            array = self._elements(
                path,
                accessor.buffer_view,
                accessor.byte_offset,
                accessor.component_type,
                accessor.type,
                accessor.count,
            )
        if accessor.sparse is not None:
            array = self._substitute(path, array, accessor, accessor.sparse)
        array = array.transpose(0, 2, 1)  # columns first in the file
        if accessor.type == "SCALAR":
            array = array[:, 0, 0]
        elif accessor.type.startswith("VEC"):
            array = array[:, :, 0]
        array.flags.writeable = False
        return array

    def _zeros(self, path: str, accessor: Accessor) -> NDArray[Any]:
        self._unbacked_elements += accessor.count
        if self._unbacked_elements > _MAX_UNBACKED_ELEMENTS:
            raise self._source.error(
                f"{path}.count",
                f"asks for {accessor.count} elements that no buffer view holds",
            )
        shape = (accessor.count, *_SHAPES[accessor.type])
        return np.zeros(shape, COMPONENTS[accessor.component_type])

    def _substitute(
        self, path: str, base: NDArray[Any], accessor: Accessor, sparse: Sparse
    ) -> NDArray[Any]:
        """A copy of ``base`` with the elements of ``sparse`` put in."""
        path = f"{path}.sparse"
        if not 1 <= sparse.count <= accessor.count:
            raise self._source.error(
                f"{path}.count", f"must be 1 to {accessor.count}"
            )
        indices = self._elements(
            f"{path}.indices",
            sparse.indices.buffer_view,
            sparse.indices.byte_offset,
            sparse.indices.component_type,
            "SCALAR",
            sparse.count,
        )[:, 0, 0].astype(np.int64)
        if indices.max() >= accessor.count:
            raise self._source.error(
                f"{path}.indices",
                f"index {indices.max()} is beyond {accessor.count} elements",
            )
        if (np.diff(indices) <= 0).any():
            raise self._source.error(
                f"{path}.indices", "must increase strictly"
            )
        values = self._elements(
            f"{path}.values",
            sparse.values.buffer_view,
            sparse.values.byte_offset,
            accessor.component_type,
            accessor.type,
            sparse.count,
        )
        array = base.copy()
        array[indices] = values
        return array

    def _elements(
        self,
        path: str,
        view_index: int,
        offset: int,
        component_type: int,
        type_: str,
        count: int,
    ) -> NDArray[Any]:
        """A view (count, columns, rows) of elements in a buffer view."""
        source = self._source
        views = source.document.buffer_views
        source.check_index(
            f"{path}.bufferView", view_index, "bufferViews", len(views)
        )
        component = COMPONENTS[component_type]
        columns, rows = _SHAPES[type_]
        column_size = rows * component.itemsize
        # Columns of matrices start at multiples of 4 bytes; the padding
        # after the last column is not needed to exist.
        column_stride = column_size
        if columns > 1:
            column_stride += -column_size % 4
        tight = columns * column_stride
        size = tight - column_stride + column_size
        stride = views[view_index].byte_stride
        if stride is None:
            stride = tight
        elif stride < size:
            raise source.error(
                f"bufferViews[{view_index}].byteStride",
                f"is {stride}, the elements of {path} have {size} bytes",
            )
        # In Python integers, which do not overflow, and before the buffer
        # is opened, let alone anything allocated.
        end = offset + (count - 1) * stride + size
        length = views[view_index].byte_length
        if end > length:
            raise source.error(
                path,
                f"needs {end} bytes of bufferViews[{view_index}], "
                f"which has {length}",
            )
        return np.ndarray(
            (count, columns, rows),
            component,
            source.view(view_index),
            offset,
            (stride, column_stride, component.itemsize),
        )
