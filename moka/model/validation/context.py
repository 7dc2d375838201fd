"""A file that is being checked: its JSON, its bytes, and what was found.

Rules of one subject ask it for objects and arrays; what an earlier rule
found broken is not there, so that a fault is not told twice.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.model.validation.issues import Place, Report

__all__ = ["COMPONENTS", "WIDTHS", "CheckedFile", "float_of", "number_of"]

COMPONENTS: dict[int, np.dtype[Any]] = {
    5120: np.dtype("<i1"),
    5121: np.dtype("<u1"),
    5122: np.dtype("<i2"),
    5123: np.dtype("<u2"),
    5125: np.dtype("<u4"),
    5126: np.dtype("<f4"),
}
# Columns and rows of an element.
WIDTHS: dict[str, tuple[int, int]] = {
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}


class CheckedFile:
    """``document`` as JSON has it, ``binary`` the chunk of a .glb or None.

    ``folder`` is where relative URIs start. ``buffers`` and ``arrays`` are
    filled by the rules of buffers and accessors: the bytes and elements
    (N, columns * rows) that may be read.
    """

    def __init__(
        self,
        document: dict[str, Any],
        report: Report,
        *,
        binary: memoryview | None = None,
        is_container: bool = False,
        folder: Path | None = None,
    ) -> None:
        self.document = document
        self.report = report
        self.binary = binary
        self.is_container = is_container
        self.folder = folder
        self.buffers: dict[int, memoryview] = {}
        self.arrays: dict[int, NDArray[Any]] = {}
        self._purposes: dict[int, str] = {}

    def add(self, code: str, place: Place, message: str) -> None:
        """Note an issue."""
        self.report.add(code, place, message)

    def all(self, kind: str) -> Iterator[tuple[int, dict[str, Any]]]:
        """The objects of an array of the document, with their numbers."""
        listed = self.document.get(kind)
        if isinstance(listed, list):
            for number, each in enumerate(listed):
                if isinstance(each, dict):
                    yield number, each

    def get(self, kind: str, index: Any) -> dict[str, Any] | None:
        """The object that an index points at, None if there is none."""
        listed = self.document.get(kind)
        if (
            not isinstance(listed, list)
            or not isinstance(index, int)
            or isinstance(index, bool)
            or not 0 <= index < len(listed)
        ):
            return None
        found = listed[index]
        return found if isinstance(found, dict) else None

    def view_bytes(self, index: Any) -> memoryview | None:
        """The bytes of a buffer view that fits its buffer."""
        view = self.get("bufferViews", index)
        if view is None:
            return None
        buffer = number_of(view.get("buffer"))
        data = None if buffer is None else self.buffers.get(buffer)
        start = number_of(view.get("byteOffset", 0))
        length = number_of(view.get("byteLength"))
        if data is None or start is None or length is None:
            return None
        return (
            data[start : start + length]
            if start + length <= len(data)
            else None
        )

    def format_of(self, index: Any) -> tuple[str, int, bool] | None:
        """Type, component type and whether normalised, of an accessor."""
        accessor = self.get("accessors", index)
        if accessor is None:
            return None
        kind, component = accessor.get("type"), accessor.get("componentType")
        if not (isinstance(kind, str) and isinstance(component, int)):
            return None
        if kind not in WIDTHS or component not in COMPONENTS:
            return None
        return kind, component, accessor.get("normalized") is True

    def array_of(self, index: Any) -> NDArray[Any] | None:
        """The elements of an accessor, None if they cannot be read."""
        number = number_of(index)
        return None if number is None else self.arrays.get(number)

    def count_of(self, index: Any) -> int | None:
        """How many elements an accessor has, None if that is not known."""
        accessor = self.get("accessors", index)
        return (number_of(accessor.get("count")) if accessor else None) or None

    def use(self, index: Any, purpose: str, place: Place) -> None:
        """Note what an accessor is for, which must be one thing."""
        first = self._purposes.setdefault(index, purpose)
        if first != purpose:
            self.add(
                "ACCESSOR_USAGE_OVERRIDE",
                place,
                f"accessors[{index}] is for {first} and for {purpose}",
            )

    def check_target(self, accessor: Any, target: int, place: Place) -> None:
        """A buffer view is for vertices or for indices."""
        found = self.get("accessors", accessor) or {}
        view = self.get("bufferViews", found.get("bufferView")) or {}
        if view.get("target", target) != target:
            self.add(
                "BUFFER_VIEW_TARGET_OVERRIDE",
                place,
                f"the buffer view has the target {view['target']}, not "
                f"{target}",
            )

    def has_stride(self, index: Any) -> bool:
        """Whether the buffer view of an accessor has a stride."""
        accessor = self.get("accessors", index) or {}
        view = self.get("bufferViews", accessor.get("bufferView")) or {}
        return "byteStride" in view

    def extension(self, owner: dict[str, Any], name: str) -> dict[str, Any]:
        """An extension of an object, empty if it has none."""
        extensions = owner.get("extensions")
        if not isinstance(extensions, dict):
            return {}
        found = extensions.get(name)
        return found if isinstance(found, dict) else {}


def float_of(value: float) -> float:
    """A number of JSON, whose integers know no limit, as a float."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def number_of(value: Any) -> int | None:
    """A non-negative integer, None for anything else."""
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return value
    return None
