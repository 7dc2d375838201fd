"""What of a primitive goes to the GPU: its vertices, or made of them.

Quads of lines, and vertices with the tangents that a normal map needs.
"""

from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import Topology
from moka.model.mesh import Primitive

__all__ = ["LINE_OTHER", "MADE_TANGENTS", "Vertices", "vertices_of"]

#: The attributes of tangents that are made for a set of coordinates.
MADE_TANGENTS = ("TANGENT_OF_UV_0", "TANGENT_OF_UV_1")

#: The attribute of a quad's corner: the other end of the segment (xyz), and
#: the side of this one as seen along the way there, 1 for left.
LINE_OTHER = "LINE_OTHER"

# Corners: left and right of the first end, then left and right of the second,
# from which the way leads back. Triangles are anticlockwise.
_END = np.array([0, 0, 1, 1])
_SIDE = np.array([1, -1, -1, 1], np.float32)
_TRIANGLES = np.array([0, 1, 2, 2, 1, 3], np.uint32)


class Vertices(Struct, frozen=True, eq=False):
    """V vertices with attributes (V, C), and what is made of them."""

    attributes: Mapping[str, NDArray[np.float32]]
    indices: NDArray[np.uint32] | None
    topology: Topology
    count: int


def vertices_of(primitive: Primitive, wanted: tuple[str, ...]) -> Vertices:
    """The attributes ``wanted`` of a primitive, LINE_OTHER among them or not.

    With it, each segment of a line is a quad of two triangles. One of
    MADE_TANGENTS stands for the tangents that the primitive lacks.
    """
    for uv_set, name in enumerate(MADE_TANGENTS):
        if name in wanted:
            return _with_tangents(primitive, uv_set, name)
    if LINE_OTHER not in wanted:
        return Vertices(
            primitive.attributes,
            primitive.indices,
            primitive.topology,
            primitive.vertex_count,
        )
    return _quads(primitive, wanted)


def _quads(primitive: Primitive, wanted: tuple[str, ...]) -> Vertices:
    from moka.model.lines import line_segments

    segments = line_segments(primitive)
    if not len(segments):
        # A mesh needs vertices; this one draws nothing.
        segments = np.zeros((1, 2), np.uint32)
    own = segments[:, _END].reshape(-1)
    attributes = {
        name: primitive.attributes[name][own]
        for name in wanted
        if name != LINE_OTHER
    }
    other = np.empty((len(own), 4), np.float32)
    other[:, :3] = primitive.attributes["POSITION"][
        segments[:, 1 - _END].reshape(-1)
    ]
    other[:, 3] = np.tile(_SIDE, len(segments))
    first = 4 * np.arange(len(segments), dtype=np.uint32)[:, None]
    return Vertices(
        {**attributes, LINE_OTHER: other},
        (first + _TRIANGLES).reshape(-1),
        Topology.TRIANGLES,
        len(own),
    )


def _with_tangents(primitive: Primitive, uv_set: int, name: str) -> Vertices:
    from moka.model.tangents import with_tangents

    # Zero bends no normal: what a texture without direction should do.
    made = with_tangents(primitive, uv_set, fill=False)
    attributes = dict(made.attributes)
    attributes[name] = attributes.pop("TANGENT")
    return Vertices(attributes, made.indices, made.topology, made.vertex_count)
