"""Tangents where a model has none, as MikkTSpace makes them.

The same frames as the reference implementation, computed for all corners at
once: corners of triangles that meet in one vertex, see the texture with the
same orientation and are connected through shared edges form a group; its
tangent is the sum of its triangles' directions of u, each projected on the
plane of the normal and weighted with the angle of its corner. A mirrored
texture thus splits vertices, and so does every seam.

The angular threshold is the reference's default of 180 degrees, with which
it splits no group. Three things differ. Where the texture gives no
direction, the tangent is some unit vector across the normal instead of +X,
which may lie along it; w is made for glTF, whose v runs downwards; and all is
computed in float64.

Sources: Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", and
his mikktspace.c; glTF 2.0 specification, section 3.7.2.1, which names it.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.core.maths import Array, normalise
from moka.model.adjacency import (
    Integers,
    connected_components,
    corner_links,
    equal_rows,
)
from moka.model.mesh import Primitive
from moka.model.triangles import triangle_corners, with_flat_normals

__all__ = ["with_tangents"]

Flags = NDArray[np.bool_]

# Lengths and areas up to this count as zero. The reference takes float32's,
# and then has no tangents for coordinates below 1e-19.
_ZERO = float(np.finfo(np.float64).tiny)


def with_tangents(
    primitive: Primitive, uv_set: int = 0, *, fill: bool = True
) -> Primitive:
    """``primitive`` as a triangle list with TANGENT for TEXCOORD_``uv_set``.

    Vertices keep their places; those whose triangles need different tangents
    are repeated at the end. Flat normals are made first if there are none.
    Where the texture gives no direction tangents are zero, unless they are
    to be ``fill``-ed with a unit vector across the normal. Points and lines
    are returned as they are. Raises ModelError if there are no such
    coordinates.
    """
    uv_name = f"TEXCOORD_{uv_set}"
    if uv_name not in primitive.attributes:
        raise ModelError(f"tangents need {uv_name}, the primitive has none")
    triangles = triangle_corners(primitive)
    if not len(triangles):
        return primitive
    if "NORMAL" not in primitive.attributes:
        primitive = with_flat_normals(primitive)
        triangles = triangle_corners(primitive)
    corners = triangles.reshape(-1).astype(np.int64)
    arrays = [
        primitive.attributes[name] for name in ("POSITION", "NORMAL", uv_name)
    ]
    points, normals, uvs = (
        np.ascontiguousarray(array.T, np.float64) for array in arrays
    )
    points, normals, uvs = (
        array.take(corners, axis=1).reshape(-1, len(triangles), 3)
        for array in (points, _unit(normals), uvs)
    )
    faces = _faces(points, uvs)
    groups = _groups(faces, equal_rows(np.hstack(arrays))[corners])
    leaders, group = _numbered(groups)
    sums: Array = np.empty((len(leaders), 3))
    for column, share in enumerate(_shares(faces, points, normals)):
        sums[:, column] = np.bincount(group, share.reshape(-1), len(leaders))
    vertex, kept_group, indices = _split(corners, group, primitive.vertex_count)
    attributes, targets = primitive.attributes, primitive.targets
    if len(vertex) > primitive.vertex_count:
        attributes = {name: array[vertex] for name, array in attributes.items()}
        targets = None if targets is None else targets.of_vertices(vertex)
    tangents = np.empty((len(vertex), 4), np.float32)
    tangents[:, :3] = _unit_across(
        sums[kept_group], attributes["NORMAL"], fill=fill
    )
    leader = leaders[kept_group]
    upright = (leader < 0) | faces.upright[leader // 3]
    tangents[:, 3] = np.where(upright, 1.0, -1.0)
    made = Primitive(
        {**attributes, "TANGENT": tangents},
        indices,
        material=primitive.material,
        targets=targets,
    )
    made.variants = primitive.variants
    return made


class _Faces(Struct, eq=False):
    """What the T triangles say of the texture.

    ``along_u`` (3, T) are unit directions of growing u, ``upright`` whether
    the texture is not mirrored, ``flat`` whether two corners are one point,
    ``blank`` whether the texture gives no direction.
    """

    along_u: Array
    upright: Flags
    flat: Flags
    blank: Flags


def _faces(points: Array, uvs: Array) -> _Faces:
    """Of corners (3, T, 3) and their texture coordinates (2, T, 3).

    Components come first here and below: each is one array to work on.
    """
    edge, other = (points[:, :, i] - points[:, :, 0] for i in (1, 2))
    (s, t), (other_s, other_t) = (uvs[:, :, i] - uvs[:, :, 0] for i in (1, 2))
    # v upwards, as for the reference.
    t, other_t = -t, -other_t
    area = s * other_t - t * other_s
    upright = area > 0
    along_u = other_t * edge - t * other
    along_v = s * other - other_s * edge
    flat = (
        (edge == 0).all(axis=0)
        | (other == 0).all(axis=0)
        | (edge == other).all(axis=0)
    )
    size = np.abs(area)
    blank = (size <= _ZERO) | (
        np.sqrt(np.minimum(_dot(along_u, along_u), _dot(along_v, along_v)))
        <= _ZERO * size
    )
    return _Faces(
        np.where(upright, 1.0, -1.0) * _unit(along_u), upright, flat, blank
    )


def _groups(faces: _Faces, vertices: Integers) -> Integers:
    """The least corner of each corner's group, -1 for corners in none.

    ``vertices`` (3 T,) are equal for corners with the same position, normal
    and texture coordinates. Sets ``faces.upright`` of blank triangles, which
    take part in the groups around them.
    """
    count = len(vertices)
    links = corner_links(vertices, ~faces.flat)
    blank = np.repeat(faces.blank & ~faces.flat, 3)
    loose = np.isin(vertices, vertices[blank])
    upright = np.repeat(faces.upright, 3)
    joined = np.flatnonzero((links >= 0) & ~loose)
    joined = joined[upright[joined] == upright[links[joined]]]
    groups = connected_components(count, joined, links[joined])
    flat = np.repeat(faces.flat, 3)
    groups[loose | flat] = -1
    _flood(faces, links, np.flatnonzero(loose & ~flat), groups)
    if not flat.any():
        return groups
    # A triangle that is no more than a line has no edges to be connected
    # through; it follows the first corner that stands where its own do.
    whole = np.flatnonzero(~flat)
    known, first = np.unique(vertices[whole], return_index=True)
    thin = np.flatnonzero(flat & np.isin(vertices, known))
    groups[thin] = groups[whole[first[np.searchsorted(known, vertices[thin])]]]
    return groups


def _flood(
    faces: _Faces, links: Integers, corners: Integers, groups: Integers
) -> None:
    """Form the groups of ``corners`` whose vertices touch blank triangles.

    A blank triangle takes the orientation of the first group that reaches
    one of its corners, so that these groups depend on their order and are
    made one after the other. Real models have few.
    """
    back = np.full(len(links), -1, np.int64)
    linked = np.flatnonzero(links >= 0)
    back[links[linked]] = linked
    for leader in corners.tolist():
        if groups[leader] >= 0 or faces.blank[leader // 3]:
            continue
        upright = faces.upright[leader // 3]
        pending = [leader]
        while pending:
            corner = pending.pop()
            face = corner // 3
            if corner < 0 or groups[corner] >= 0:
                continue
            if (
                faces.blank[face]
                and (groups[3 * face : 3 * face + 3] < 0).all()
            ):
                faces.upright[face] = upright
            if faces.upright[face] == upright:
                groups[corner] = leader
                pending += [int(links[corner]), int(back[corner])]


def _shares(faces: _Faces, points: Array, normals: Array) -> Array:
    """What each corner (3, T, 3) adds to its group's tangent, a vector."""
    along_u = faces.along_u[:, :, None]
    projected = _unit(along_u - _dot(along_u, normals) * normals)
    # Angles between the edges as they are seen along the normal.
    following = np.roll(points, -1, axis=2) - points
    preceding = -np.roll(following, 1, axis=2)
    following, preceding = (
        _unit(edge - _dot(edge, normals) * normals)
        for edge in (following, preceding)
    )
    angle = np.arccos(np.clip(_dot(following, preceding), -1.0, 1.0))
    angle[faces.flat | faces.blank] = 0.0
    return np.asarray(angle * projected)


def _numbered(groups: Integers) -> tuple[Integers, Integers]:
    """The leaders of all groups in order, and each corner's place there.

    -1 is a group too.
    """
    is_leader = np.zeros(len(groups) + 1, np.bool_)
    is_leader[groups] = True  # -1 is the last
    is_leader = np.roll(is_leader, 1)
    number = np.cumsum(is_leader) - 1
    return np.flatnonzero(is_leader) - 1, number[groups + 1]


def _split(
    corners: Integers, group: Integers, count: int
) -> tuple[Integers, Integers, Integers]:
    """Vertices that belong to one group each.

    Of C corners, which name ``count`` vertices and their groups: the old
    vertex and the group of V new ones, and the new vertex of each corner.
    The old ones are the first; a vertex that no corner names is in group 0.
    """
    own = np.zeros(count, np.int64)
    own[corners] = group
    loose = np.flatnonzero(own[corners] != group)
    pair = corners[loose] * (group.max(initial=0) + 1) + group[loose]
    pairs, place = np.unique(pair, return_inverse=True)
    indices = corners.copy()
    indices[loose] = count + place
    vertex, other = np.divmod(pairs, group.max(initial=0) + 1)
    return (
        np.concatenate([np.arange(count), vertex]),
        np.concatenate([own, other]),
        indices,
    )


def _unit_across(
    vectors: Array, normals: NDArray[np.float32], *, fill: bool
) -> Array:
    """Unit vectors (V, 3), or zero and what stands for it."""
    units = np.ascontiguousarray(_unit(vectors.T).T)
    none = np.flatnonzero((np.abs(vectors) <= _ZERO).all(axis=-1))
    units[none] = 0.0
    if fill and len(none):
        across = normalise(normals[none])
        axis = np.eye(3)[np.abs(across).argmin(axis=-1)]
        along = (axis * across).sum(axis=-1, keepdims=True)
        units[none] = normalise(axis - along * across)
    return units


def _dot(first: Array, second: Array) -> Array:
    """Products of vectors whose components come first."""
    x, y, z = first * second
    return np.asarray(x + y + z)


def _unit(vectors: Array) -> Array:
    """Vectors of length 1, or 0; their components come first.

    What is made of float32 neither overflows nor vanishes when squared.
    """
    length = np.sqrt(_dot(vectors, vectors))
    length[length <= _ZERO] = 1.0
    return vectors / length
