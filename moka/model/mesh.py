"""Meshes: primitives with their vertex attributes as NumPy arrays."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike, NDArray

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.material.material import Material

if TYPE_CHECKING:
    from moka.model.morphs import MorphTargets
    from moka.model.skins import JointBoxes

__all__ = [
    "ATTRIBUTES",
    "INFLUENCES",
    "INFLUENCE_SETS",
    "TOPOLOGIES",
    "Bounds",
    "Mesh",
    "Primitive",
]

Bounds = tuple[NDArray[np.float32], NDArray[np.float32]]

# Sets of four joints each that a vertex can follow: with all other inputs of
# a vertex they fill the 16 attributes that OpenGL promises.
INFLUENCE_SETS = 3

INFLUENCES = tuple(
    f"{kind}_{number}"
    for kind in ("JOINTS", "WEIGHTS")
    for number in range(INFLUENCE_SETS)
)

# The attributes that moka reads and their components, in this order.
ATTRIBUTES: dict[str, int] = {
    "POSITION": 3,
    "NORMAL": 3,
    "TANGENT": 4,
    "TEXCOORD_0": 2,
    "TEXCOORD_1": 2,
    "COLOR_0": 4,
    **dict.fromkeys(INFLUENCES, 4),
}

# The topologies in the order of glTF's modes 0 to 6.
TOPOLOGIES = (
    Topology.POINTS,
    Topology.LINES,
    Topology.LINE_LOOP,
    Topology.LINE_STRIP,
    Topology.TRIANGLES,
    Topology.TRIANGLE_STRIP,
    Topology.TRIANGLE_FAN,
)


class Primitive:
    """Geometry that is drawn with one material.

    ``attributes`` maps names of glTF to float32 arrays of one length:
    POSITION (N, 3) in metres, NORMAL (N, 3), TANGENT (N, 4) with the sign of
    the bitangent in w, TEXCOORD_0 and TEXCOORD_1 (N, 2) with v downwards,
    COLOR_0 (N, 4) linear RGBA, JOINTS_0 to JOINTS_2 (N, 4) numbers of joints
    in a skin with WEIGHTS_0 to WEIGHTS_2 (N, 4), of which each vertex has 1.
    Only POSITION is always there. Arrays read from a file may be read-only,
    strided, and shared between primitives. ``indices`` is uint32 (M,) or
    None, ``targets`` are morph targets or None, ``material`` is None for
    glTF's default. ``vertex_count``, ``index_count`` and ``bounds``, the
    least and the greatest position, stay after :meth:`release`.
    ``variants`` are materials by the number of the model's variant in which
    they take the place of ``material``. ``geometry`` is the same object for
    all that share arrays.

    Raises ModelError for attributes or indices of a wrong shape, positions
    that are not finite, and indices of vertices that do not exist.
    """

    __slots__ = (
        "_joint_boxes",
        "_shared",
        "attributes",
        "bounds",
        "geometry",
        "index_count",
        "indices",
        "material",
        "targets",
        "topology",
        "variants",
        "vertex_count",
    )

    def __init__(
        self,
        attributes: Mapping[str, ArrayLike],
        indices: ArrayLike | None = None,
        *,
        topology: Topology = Topology.TRIANGLES,
        material: Material | None = None,
        targets: "MorphTargets | None" = None,
    ) -> None:
        if "POSITION" not in attributes:
            raise ModelError("a primitive needs the attribute POSITION")
        self.topology = topology
        self.material = material
        self.targets = targets
        self.variants: dict[int, Material] = {}
        self.geometry = object()
        self._shared: dict[Material, Primitive] = {}
        self._joint_boxes: JointBoxes | None = None
        self.attributes: dict[str, NDArray[np.float32]] = {
            name: np.asarray(attributes[name], np.float32)
            for name in ATTRIBUTES
            if name in attributes
        }
        self.vertex_count = len(self.attributes["POSITION"])
        for name, array in self.attributes.items():
            shape = (self.vertex_count, ATTRIBUTES[name])
            if array.shape != shape:
                raise ModelError(
                    f"{name} has the shape {array.shape}, not {shape}"
                )
        self.bounds = _bounds(self.attributes["POSITION"])
        self.indices: NDArray[np.uint32] | None = None
        self.index_count = 0
        if indices is not None:
            self.indices = _checked_indices(indices, self.vertex_count)
            self.index_count = len(self.indices)

    def __repr__(self) -> str:
        return (
            f"Primitive({self.topology.name}, {self.vertex_count} vertices, "
            f"{self.index_count} indices)"
        )

    @property
    def element_count(self) -> int:
        """Points, lines or triangles that are drawn."""
        count = self.index_count or self.vertex_count
        match self.topology:
            case Topology.POINTS:
                return count
            case Topology.LINES:
                return count // 2
            case Topology.LINE_LOOP:
                return count if count > 1 else 0
            case Topology.LINE_STRIP:
                return max(0, count - 1)
            case Topology.TRIANGLES:
                return count // 3
        return max(0, count - 2)

    @property
    def influence_sets(self) -> int:
        """Sets of four joints that its vertices follow; 0 if it is rigid."""
        return sum(name.startswith("JOINTS_") for name in self.attributes)

    @property
    def joint_boxes(self) -> "JointBoxes":
        """The boxes of the joints that it follows, found when first asked."""
        if self._joint_boxes is None:
            from moka.model.skins import joint_boxes

            self._joint_boxes = joint_boxes(self)
        return self._joint_boxes

    @property
    def morphed(self) -> frozenset[str]:
        """The attributes that its morph targets change."""
        if self.targets is None:
            return frozenset()
        return self.targets.attributes

    @property
    def size(self) -> int:
        """Bytes of the attributes and indices that are still held."""
        size = 0 if self.indices is None else self.indices.nbytes
        return size + sum(array.nbytes for array in self.attributes.values())

    def with_material(self, material: Material | None) -> "Primitive":
        """The same geometry, sharing its arrays, with another material."""
        copy = object.__new__(Primitive)
        for name in Primitive.__slots__:
            setattr(copy, name, getattr(self, name))
        copy.attributes = dict(self.attributes)
        copy.material = material
        copy._shared = {}
        return copy

    def as_rigid(self) -> "Primitive":
        """The same geometry, sharing its arrays, without joints."""
        copy = self.with_material(self.material)
        copy.attributes = {
            name: array
            for name, array in self.attributes.items()
            if name not in INFLUENCES
        }
        return copy

    def of_variant(self, variant: int | None) -> "Primitive":
        """The primitive in a variant of its model, itself if none is named.

        Asked again it is the same object, so that what was prepared for it
        is found.
        """
        if variant is None or variant not in self.variants:
            return self
        return self.shared_with(self.variants[variant])

    def shared_with(self, material: Material) -> "Primitive":
        """As :meth:`with_material`, but the same object for each material."""
        if material is self.material:
            return self
        if material not in self._shared:
            self._shared[material] = self.with_material(material)
        return self._shared[material]

    def release(self) -> None:
        """Drop the arrays, for instance once the GPU holds them."""
        self.attributes.clear()
        self.indices = None
        self.targets = None


class Mesh(Struct, eq=False):
    """Primitives that nodes place together.

    ``weights`` are the default weights of their morph targets, empty for
    zeros; ``target_count`` is how many targets each of them has, by default
    as many as they have.
    """

    name: str
    primitives: list[Primitive]
    weights: list[float] = []
    target_count: int = 0

    def __post_init__(self) -> None:
        """Count the targets of primitives that were made in memory."""
        if not self.target_count:
            self.target_count = max(
                (len(each.targets or ()) for each in self.primitives),
                default=0,
            )


def _bounds(positions: NDArray[np.float32]) -> Bounds:
    """From the data and not from what the file says of it."""
    if not len(positions):
        raise ModelError("POSITION is empty")
    # Along columns: a sixteenth of the time that NumPy takes across rows.
    least = np.array([column.min() for column in positions.T])
    greatest = np.array([column.max() for column in positions.T])
    # Both pass on NaN, and an infinity is an extreme.
    if not (np.isfinite(least).all() and np.isfinite(greatest).all()):
        first = np.flatnonzero(~np.isfinite(positions).all(axis=1))[0]
        raise ModelError(f"POSITION of vertex {first} is not finite")
    return least, greatest


def _checked_indices(
    indices: ArrayLike, vertex_count: int
) -> NDArray[np.uint32]:
    array = np.asarray(indices)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise ModelError("indices must be integers in one dimension")
    if not len(array):
        raise ModelError("indices are empty; leave them out")
    if not 0 <= array.min() <= array.max() < vertex_count:
        wrong = (array < 0) | (array >= vertex_count)
        first = np.flatnonzero(wrong)[0]
        raise ModelError(
            f"index {array[first]} at {first} is beyond the {vertex_count} "
            "vertices"
        )
    return array.astype(np.uint32, copy=False)
