"""Instances of a node's mesh, as rows of nodes below it.

An instance is a node without a name: the arrays of a tree hold a hundred
thousand of them as readily as the file's accessors do, and everything that
follows (bounds, culling, keys) handles them one by one without knowing.

Source: EXT_mesh_gpu_instancing.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.maths import Array, compose
from moka.model.accessors import AccessorReader
from moka.model.schema import Index, Node, read_extension
from moka.model.source import GltfSource

__all__ = ["NodeInstances", "read_instances"]

_EXTENSION = "EXT_mesh_gpu_instancing"

# Attributes that place an instance: their type, and what stands for one that
# is not given. Others, such as _ID, are for applications.
_PLACING = {
    "TRANSLATION": ("VEC3", (0.0, 0.0, 0.0)),
    "ROTATION": ("VEC4", (0.0, 0.0, 0.0, 1.0)),
    "SCALE": ("VEC3", (1.0, 1.0, 1.0)),
}
_UNSIGNED_INT, _FLOAT = 5125, 5126


class _Instancing(Struct):
    attributes: dict[str, Index]


class NodeInstances(Struct, frozen=True):
    """I instances: ``node`` (I,) in the file, ``local`` (I, 4, 4) in it."""

    node: NDArray[np.int32]
    local: Array


def read_instances(
    source: GltfSource, nodes: Sequence[tuple[int, Node]]
) -> NodeInstances:
    """The instances of ``nodes``, pairs of an index and the node itself.

    Translations and scales are floats, rotations floats or normalised
    integers of unit or any other length; other types are read as
    KHR_mesh_quantization would have them. At least one node must have the
    extension. Raises ModelError naming the JSON path of what is wrong.
    """
    accessors = AccessorReader(source)
    placed = [
        (index, local)
        for index, node in nodes
        if (local := _matrices(source, accessors, index, node)) is not None
    ]
    counts = [len(local) for _, local in placed]
    return NodeInstances(
        np.repeat(np.array([node for node, _ in placed], np.int32), counts),
        np.concatenate([local for _, local in placed]),
    )


def _matrices(
    source: GltfSource, accessors: AccessorReader, index: int, node: Node
) -> Array | None:
    owner = f"nodes[{index}]"
    extension = read_extension(
        node, _EXTENSION, _Instancing, source.where, owner
    )
    if extension is None:
        return None
    path = f"{owner}.extensions.{_EXTENSION}.attributes"
    if not extension.attributes:
        raise source.error(path, "is empty, so that nothing can be counted")
    count = _count(source, path, extension.attributes)
    values = []
    for name, (_, default) in _PLACING.items():
        number = extension.attributes.get(name, -1)
        array = (
            np.asarray(default)[None]
            if number < 0
            else accessors.floats(number).astype(np.float64)
        )
        if not np.isfinite(array).all():
            row = np.flatnonzero(~np.isfinite(array).all(axis=1))[0]
            raise source.error(
                f"{path}.{name}", f"of instance {row} is not finite"
            )
        values.append(array)
    local = compose(*values)
    return np.broadcast_to(local, (count, 4, 4))


def _count(source: GltfSource, path: str, attributes: dict[str, int]) -> int:
    """How many instances there are, once the accessors may be read."""
    accessors = source.document.accessors
    first, count = "", 0
    for name, number in attributes.items():
        place = f"{path}.{name}"
        source.check_index(place, number, "accessors", len(accessors))
        accessor = accessors[number]
        if not first:
            first, count = name, accessor.count
        elif accessor.count != count:
            raise source.error(
                place, f"has {accessor.count} elements, {first} has {count}"
            )
        if name not in _PLACING:
            continue
        expected = _PLACING[name][0]
        if accessor.type != expected:
            raise source.error(
                place,
                f"accessors[{number}] is {accessor.type}, not {expected}",
            )
        if accessor.component_type == _UNSIGNED_INT:
            raise source.error(
                place, f"accessors[{number}] has 32-bit integers"
            )
        is_float = accessor.component_type == _FLOAT
        if name == "ROTATION" and not (is_float or accessor.normalized):
            raise source.error(
                place,
                f"accessors[{number}] has integers that are not normalised",
            )
    return count
