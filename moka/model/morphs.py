"""Morph targets: what they add to vertices, and how much of each.

Source: glTF 2.0 specification, section 3.7.2.2 (morph targets).
"""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.core.maths import Array
from moka.model import schema
from moka.model.accessors import AccessorReader
from moka.model.source import GltfSource

__all__ = [
    "LARGEST_WEIGHT",
    "MORPHED",
    "MorphTargets",
    "check_targets",
    "check_weights",
    "read_targets",
]

# A sum over hundreds of targets stays far inside float32.
LARGEST_WEIGHT = 1e18

# What targets add to: the attribute, and how many components they give.
MORPHED: dict[str, int] = {
    "POSITION": 3,
    "NORMAL": 3,
    "TANGENT": 3,
    "TEXCOORD_0": 2,
    "TEXCOORD_1": 2,
    "COLOR_0": 4,
}

Deltas = Mapping[str, NDArray[np.float32]]


class MorphTargets:
    """What T targets add to the N vertices of one primitive.

    ``deltas`` has for each target float32 arrays (N, C) by attribute, C as
    in :data:`MORPHED`; what a target leaves as it is, is not there. Raises
    ModelError for arrays of another shape or with entries that are not
    finite.
    """

    def __init__(self, deltas: Sequence[Deltas]) -> None:
        self.deltas: list[Deltas] = [dict(target) for target in deltas]
        self._extents: Array | None = None
        for number, target in enumerate(self.deltas):
            for name, array in target.items():
                if array.ndim != 2 or array.shape[1] != MORPHED[name]:
                    raise ModelError(
                        f"{name} of target {number} has the shape {array.shape}"
                    )
                # NaN passes through both, and an infinity is an extreme.
                if not np.isfinite([array.min(), array.max()]).all():
                    raise ModelError(
                        f"{name} of target {number} has entries that are not "
                        "finite"
                    )

    def __len__(self) -> int:
        return len(self.deltas)

    @property
    def attributes(self) -> frozenset[str]:
        """The attributes that any of the targets changes."""
        return frozenset().union(*self.deltas)

    @property
    def size(self) -> int:
        """Bytes of all deltas."""
        return sum(
            array.nbytes for target in self.deltas for array in target.values()
        )

    @property
    def extents(self) -> Array:
        """The least and the greatest that targets add to positions.

        Float64 (T, 2, 3) in metres, computed when first asked for.
        """
        if self._extents is None:
            extents = np.zeros((len(self), 2, 3))
            for number, target in enumerate(self.deltas):
                moved = target.get("POSITION")
                if moved is not None:
                    extents[number] = moved.min(axis=0), moved.max(axis=0)
            self._extents = extents
        return self._extents

    def spread(self, weights: NDArray[np.float32]) -> Array:
        """What positions can gain with ``weights`` (..., T).

        Boxes (..., 2, 3), least and greatest corner: each target's extent
        times its weight, added up. No vertex moves out of the box of all
        vertices that has grown by this.
        """
        more = np.maximum(weights, 0).astype(np.float64)
        less = np.minimum(weights, 0).astype(np.float64)
        low, high = self.extents[:, 0], self.extents[:, 1]
        return np.stack(
            [more @ low + less @ high, more @ high + less @ low], axis=-2
        )

    def of_vertices(self, vertices: NDArray[np.integer]) -> "MorphTargets":
        """The targets of vertices (M,) out of the N."""
        return MorphTargets(
            [
                {name: array[vertices] for name, array in target.items()}
                for target in self.deltas
            ]
        )

    def without(self, names: Collection[str]) -> "MorphTargets":
        """The targets as far as they change other attributes."""
        return MorphTargets(
            [
                {
                    name: array
                    for name, array in target.items()
                    if name not in names
                }
                for target in self.deltas
            ]
        )


def check_targets(source: GltfSource, path: str, mesh: schema.Mesh) -> None:
    """Raise ModelError unless the mesh's counts of targets agree."""
    count = mesh.target_count
    for number, primitive in enumerate(mesh.primitives):
        if len(primitive.targets) != count:
            raise source.error(
                f"{path}.primitives[{number}].targets",
                f"are {len(primitive.targets)}, those of the first primitive "
                f"are {count}",
            )
    if mesh.weights:
        check_weights(source, f"{path}.weights", mesh.weights, count)


def check_weights(
    source: GltfSource, path: str, weights: Sequence[float], count: int
) -> None:
    """Raise ModelError unless there are ``count`` weights in range."""
    if len(weights) != count:
        raise source.error(
            path, f"are {len(weights)} for {count} morph targets"
        )
    if max(map(abs, weights)) > LARGEST_WEIGHT:
        raise source.error(path, f"are beyond {LARGEST_WEIGHT:g}")


def read_targets(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    primitive: schema.Primitive,
    present: Mapping[str, NDArray[np.float32]],
) -> MorphTargets:
    """The morph targets of a primitive whose attributes are ``present``.

    What targets add to attributes that are not there is left out. Raises
    ModelError naming the JSON path of what is wrong.
    """
    deltas = []
    for number, target in enumerate(primitive.targets):
        place = f"{path}.targets[{number}]"
        deltas.append(
            {
                name: _read_deltas(
                    source,
                    accessors,
                    f"{place}.{name}",
                    name,
                    index,
                    len(present["POSITION"]),
                )
                for name, index in target.items()
                if name in MORPHED and name in present
            }
        )
    try:
        return MorphTargets(deltas)
    except ModelError as error:
        raise source.error(f"{path}.targets", str(error)) from error


def _read_deltas(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    name: str,
    index: int,
    vertex_count: int,
) -> NDArray[np.float32]:
    """One attribute of one target; a colour without alpha adds none."""
    document = source.document
    source.check_index(path, index, "accessors", len(document.accessors))
    kind = document.accessors[index].type
    width = MORPHED[name]
    types = ("VEC3", "VEC4") if name == "COLOR_0" else (f"VEC{width}",)
    if kind not in types:
        raise source.error(
            path, f"accessors[{index}] is {kind}, not {' or '.join(types)}"
        )
    array = accessors.floats(index)
    if len(array) != vertex_count:
        raise source.error(
            path,
            f"has {len(array)} elements, POSITION has {vertex_count}",
        )
    if array.shape[1] < width:
        padded = np.zeros((vertex_count, width), np.float32)
        padded[:, : array.shape[1]] = array
        return padded
    return array
