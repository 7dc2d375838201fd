"""Segments of lists, strips and loops of lines.

Source: glTF 2.0 specification, section 3.7.2.1 (topologies).
"""

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import Topology
from moka.model.mesh import Primitive

__all__ = ["line_segments"]


def line_segments(primitive: Primitive) -> NDArray[np.uint32]:
    """Vertex indices (S, 2) of the segments, in their order.

    An odd vertex at the end of a list is left out; the last segment of a
    loop leads back to its first vertex. Points and triangles have no
    segments: shape (0, 2).
    """
    order = primitive.indices
    if order is None:
        order = np.arange(primitive.vertex_count, dtype=np.uint32)
    match primitive.topology:
        case Topology.LINES:
            return order[: len(order) // 2 * 2].reshape(-1, 2)
        case Topology.LINE_STRIP:
            return np.stack([order[:-1], order[1:]], axis=1)
        case Topology.LINE_LOOP if len(order) > 1:
            return np.stack([order, np.roll(order, -1)], axis=1)
    return np.empty((0, 2), np.uint32)
