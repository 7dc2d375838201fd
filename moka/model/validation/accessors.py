"""Accessors: where their elements lie, and what is stored there."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.model.validation.context import (
    COMPONENTS,
    WIDTHS,
    CheckedFile,
    float_of,
    number_of,
)
from moka.model.validation.issues import Place

__all__ = ["check_accessors"]

_UNSIGNED_INT, _FLOAT = 5125, 5126
# Elements that no byte of the file backs; beyond them data go unchecked.
_MOST_ZEROS = 1 << 22
_COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")


def check_accessors(file: CheckedFile) -> None:
    """Check all accessors; ``file.arrays`` has those that can be read."""
    for number, accessor in file.all("accessors"):
        place: Place = ("accessors", number)
        layout = file.format_of(number)
        count = number_of(accessor.get("count"))
        if "byteOffset" in accessor and "bufferView" not in accessor:
            file.add(
                "UNSATISFIED_DEPENDENCY",
                (*place, "byteOffset"),
                "an offset needs a buffer view",
            )
        if layout is None:
            continue
        kind, component, normalised = layout
        if normalised and component in (_UNSIGNED_INT, _FLOAT):
            file.add(
                "ACCESSOR_NORMALIZED_INVALID",
                (*place, "normalized"),
                "only integers of 8 and 16 bits can be normalised",
            )
        _check_limits(file, accessor, place)
        if not count:
            continue
        array = None
        if "bufferView" in accessor:
            array = _elements(file, accessor, place, component, kind, count)
        if isinstance(accessor.get("sparse"), dict):
            array = _with_sparse(
                file, accessor, place, array, component, kind, count
            )
        if array is None:
            continue
        file.arrays[number] = array
        _check_data(file, accessor, place, array)


def _check_limits(
    file: CheckedFile, accessor: dict[str, Any], place: Place
) -> None:
    columns, rows = WIDTHS[accessor["type"]]
    for name in ("min", "max"):
        given = accessor.get(name)
        if isinstance(given, list) and given and len(given) != columns * rows:
            file.add(
                "ARRAY_LENGTH_NOT_IN_LIST",
                (*place, name),
                f"has {len(given)} elements, not {columns * rows}",
            )


def _elements(
    file: CheckedFile,
    owner: dict[str, Any],
    place: Place,
    component: int,
    kind: str,
    count: int,
) -> NDArray[Any] | None:
    """Elements (N, components) in a buffer view, None if they do not fit."""
    view = file.get("bufferViews", owner.get("bufferView"))
    offset = number_of(owner.get("byteOffset", 0))
    if view is None or offset is None:
        return None
    if any(file.extension(view, name) for name in _COMPRESSED):
        return None
    dtype, (columns, rows) = COMPONENTS[component], WIDTHS[kind]
    unit = dtype.itemsize
    column = rows * unit
    step = column + (-column % 4 if columns > 1 else 0)
    size = (columns - 1) * step + column
    fits = True
    if offset % unit:
        file.add(
            "ACCESSOR_OFFSET_ALIGNMENT",
            (*place, "byteOffset"),
            f"is {offset}, no multiple of {unit}",
        )
    start = number_of(view.get("byteOffset", 0)) or 0
    if (start + offset) % unit:
        file.add(
            "ACCESSOR_TOTAL_OFFSET_ALIGNMENT",
            place,
            f"begins at byte {start + offset}, no multiple of {unit}",
        )
    if columns > 1 and (start + offset) % 4:
        file.add(
            "ACCESSOR_MATRIX_ALIGNMENT", place, "does not begin at 4 bytes"
        )
    stride = number_of(view.get("byteStride"))
    if stride is None or not 4 <= stride <= 252:
        stride = columns * step
    elif stride < size:
        file.add(
            "ACCESSOR_SMALL_BYTESTRIDE",
            place,
            f"elements of {size} bytes do not fit a stride of {stride}",
        )
        fits = False
    length = number_of(view.get("byteLength"))
    needed = (count - 1) * stride + size
    if length is None or (fits and offset + needed > length):
        if length is not None:
            file.add(
                "ACCESSOR_TOO_LONG",
                place,
                f"needs bytes {offset} to {offset + needed} of a view of "
                f"{length}",
            )
        fits = False
    data = file.view_bytes(owner.get("bufferView"))
    if not fits or data is None:
        return None
    array: NDArray[Any] = np.ndarray(
        (count, columns, rows), dtype, data, offset, (stride, step, unit)
    )
    return array.reshape(count, columns * rows)


def _with_sparse(
    file: CheckedFile,
    accessor: dict[str, Any],
    place: Place,
    base: NDArray[Any] | None,
    component: int,
    kind: str,
    count: int,
) -> NDArray[Any] | None:
    """``base``, zeros for None, with the sparse elements; None if broken."""
    place = (*place, "sparse")
    sparse = accessor["sparse"]
    number = number_of(sparse.get("count"))
    indices, values = sparse.get("indices"), sparse.get("values")
    if not number or not (
        isinstance(indices, dict) and isinstance(values, dict)
    ):
        return None
    if number > count:
        file.add(
            "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE",
            (*place, "count"),
            f"is {number}, the accessor has {count} elements",
        )
    index_type = indices.get("componentType")
    places = None
    if index_type in (5121, 5123, 5125):
        places = _elements(
            file, indices, (*place, "indices"), index_type, "SCALAR", number
        )
    for name, owner in (("indices", indices), ("values", values)):
        view = file.get("bufferViews", owner.get("bufferView")) or {}
        if "target" in view:
            file.add(
                "BUFFER_VIEW_TARGET_OVERRIDE",
                (*place, name, "bufferView"),
                f"the buffer view has the target {view['target']}",
            )
    new = _elements(file, values, (*place, "values"), component, kind, number)
    if places is None:
        return None
    flat = places[:, 0].astype(np.int64)
    if (flat >= count).any():
        first = int(np.flatnonzero(flat >= count)[0])
        file.add(
            "ACCESSOR_SPARSE_INDEX_OOB",
            place,
            f"index {flat[first]} at {first} is beyond {count} elements",
        )
    if (np.diff(flat) <= 0).any():
        first = int(np.flatnonzero(np.diff(flat) <= 0)[0]) + 1
        file.add(
            "ACCESSOR_SPARSE_INDICES_NON_INCREASING",
            place,
            f"index {flat[first]} at {first} does not exceed the one before",
        )
    if new is None or (flat >= count).any():
        return None
    columns, rows = WIDTHS[kind]
    if base is None and count > _MOST_ZEROS:
        return None
    if base is None:
        base = np.zeros((count, columns * rows), COMPONENTS[component])
    array = base.copy()
    array[flat] = new
    return array


def _check_data(
    file: CheckedFile,
    accessor: dict[str, Any],
    place: Place,
    array: NDArray[Any],
) -> None:
    if array.dtype.kind == "f":
        # A sum is finite where all its terms are, and costs no copy.
        with np.errstate(over="ignore", invalid="ignore"):
            doubtful = not np.isfinite(array.sum(dtype=np.float64))
        if doubtful and not np.isfinite(array).all():
            first = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
            file.add(
                "ACCESSOR_INVALID_FLOAT",
                place,
                f"element {first} is not finite",
            )
            return
    for name, code, reduce, beyond in (
        ("min", "MIN", np.min, np.less),
        ("max", "MAX", np.max, np.greater),
    ):
        given = accessor.get(name)
        if not isinstance(given, list) or len(given) != array.shape[1]:
            continue
        for index, declared in enumerate(given):
            if not isinstance(declared, int | float):
                continue
            column = array[:, index]
            # A bound of floats is a decimal number that stands for a float.
            bound: Any = float_of(declared)
            if array.dtype.kind == "f":
                with np.errstate(over="ignore"):
                    bound = np.float32(bound)
            actual = reduce(column)
            if actual == bound:
                continue
            where = (*place, name, index)
            file.add(
                f"ACCESSOR_{code}_MISMATCH",
                where,
                f"is {declared}, in the data it is {actual}",
            )
            count = int(np.count_nonzero(beyond(column, bound)))
            if count:
                file.add(
                    f"ACCESSOR_ELEMENT_OUT_OF_{code}_BOUND",
                    where,
                    f"{count} elements are beyond {declared}",
                )
