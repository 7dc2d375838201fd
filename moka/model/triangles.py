"""Triangles of lists, strips and fans; flat normals.

Source: glTF 2.0 specification, section 3.7.2.1 (topologies, normals).
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import Topology
from moka.model.mesh import Primitive

__all__ = ["triangle_corners", "with_flat_normals"]


def triangle_corners(primitive: Primitive) -> NDArray[np.uint32]:
    """Vertex indices (T, 3) of the triangles, front faces anticlockwise.

    Every second triangle of a strip is turned round, a fan ends its
    triangles in the common vertex, both as the specification orders them.
    Points and lines have no triangles: shape (0, 3).
    """
    order = primitive.indices
    if order is None:
        order = np.arange(primitive.vertex_count, dtype=np.uint32)
    match primitive.topology:
        case Topology.TRIANGLES:
            return order[: len(order) // 3 * 3].reshape(-1, 3)
        case Topology.TRIANGLE_STRIP:
            first = np.arange(max(0, len(order) - 2))[:, None]
            odd = first % 2
            return order[first + np.hstack([0 * odd, 1 + odd, 2 - odd])]
        case Topology.TRIANGLE_FAN:
            first = np.arange(max(0, len(order) - 2))[:, None]
            return order[np.hstack([first + 1, first + 2, 0 * first])]
    return np.empty((0, 3), np.uint32)


def with_flat_normals(primitive: Primitive) -> Primitive:
    """``primitive`` as separate triangles, each with its geometric normal.

    What the specification demands where normals are missing; tangents are
    dropped, since those that belong to other normals must be ignored.
    Triangles without area get the normal +Z. Points and lines, which have
    no face, are returned as they are.
    """
    order = triangle_corners(primitive).reshape(-1)
    if not len(order):
        return primitive
    attributes = {
        name: array[order]
        for name, array in primitive.attributes.items()
        if name not in ("NORMAL", "TANGENT")
    }
    corners = attributes["POSITION"].astype(np.float64).reshape(-1, 3, 3)
    normals = np.cross(
        corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    )
    attributes["NORMAL"] = np.repeat(_unit_or_z(normals), 3, axis=0)
    targets = primitive.targets
    if targets is not None:
        targets = targets.without(("NORMAL", "TANGENT")).of_vertices(order)
    return Primitive(attributes, material=primitive.material, targets=targets)


def _unit_or_z(vectors: NDArray[np.float64]) -> NDArray[Any]:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit = vectors / np.where(length > 0, length, 1)
    return np.where(length > 0, unit, (0.0, 0.0, 1.0)).astype(np.float32)
