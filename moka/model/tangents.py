"""Tangents where a model has none, as MikkTSpace makes them.

The same frames as the reference implementation, computed for all corners at
once: corners of triangles that meet in one vertex, see the texture with the
same orientation and are connected through shared edges form a group; its
tangent is the sum of its triangles' directions of u, each projected on the
plane of the normal and weighted with the angle of its corner. A mirrored
texture thus splits vertices, and so does every seam.

The angular threshold is the reference's default of 180 degrees, with which
it splits no group. Two things differ. Where the texture gives no direction,
the tangent is some unit vector across the normal instead of +X, which may
lie along it; and w is made for glTF, whose v runs downwards.

Sources: Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", and
his mikktspace.c; glTF 2.0 specification, section 3.7.2.1, which names it.
"""

from dataclasses import dataclass

import numpy as np
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

# Lengths and areas up to this count as zero, as in the reference.
_ZERO = float(np.finfo(np.float32).tiny)


def with_tangents(primitive: Primitive, uv_set: int = 0) -> Primitive:
    """``primitive`` as a triangle list with TANGENT for TEXCOORD_``uv_set``.

    Vertices are split where their triangles need different tangents; flat
    normals are made first if there are none. Points and lines are returned
    as they are. Raises ModelError if there are no such coordinates.
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
    vertices = equal_rows(
        np.hstack(
            [
                primitive.attributes[name]
                for name in ("POSITION", "NORMAL", uv_name)
            ]
        )
    )[corners]
    points, normals, uvs = (
        primitive.attributes[name][triangles].astype(np.float64)
        for name in ("POSITION", "NORMAL", uv_name)
    )
    normals = normalise(normals)
    faces = _faces(points, uvs)
    groups = _groups(faces, vertices)
    shares = _shares(faces, points, normals).reshape(-1, 3)
    leaders, group = np.unique(groups, return_inverse=True)
    sums = np.stack([np.bincount(group, share) for share in shares.T], axis=-1)
    # A corner of a vertex and a group is one vertex; -1 is a group too.
    kept, indices = np.unique(
        corners * len(leaders) + group, return_inverse=True
    )
    vertex, kept_group = kept // len(leaders), kept % len(leaders)
    attributes = {
        name: array[vertex] for name, array in primitive.attributes.items()
    }
    leader = leaders[kept_group]
    upright = (leader < 0) | faces.upright[leader // 3]
    attributes["TANGENT"] = np.column_stack(
        [
            _unit_across(sums[kept_group], attributes["NORMAL"]),
            np.where(upright, 1.0, -1.0),
        ]
    ).astype(np.float32)
    targets = primitive.targets
    return Primitive(
        attributes,
        indices,
        material=primitive.material,
        targets=None if targets is None else targets.of_vertices(vertex),
    )


@dataclass(slots=True)
class _Faces:
    """What the T triangles say of the texture.

    ``along_u`` (T, 3) are unit directions of growing u, ``upright`` whether
    the texture is not mirrored, ``flat`` whether two corners are one point,
    ``blank`` whether the texture gives no direction.
    """

    along_u: Array
    upright: Flags
    flat: Flags
    blank: Flags


def _faces(points: Array, uvs: Array) -> _Faces:
    """Of corners (T, 3, 3) and their texture coordinates (T, 3, 2)."""
    edge, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    # v upwards, as for the reference.
    uvs = uvs * (1.0, -1.0)
    (s, t), (other_s, other_t) = (
        (uvs[:, 1] - uvs[:, 0]).T,
        (uvs[:, 2] - uvs[:, 0]).T,
    )
    area = s * other_t - t * other_s
    upright = area > 0
    along_u = other_t[:, None] * edge - t[:, None] * other
    along_v = s[:, None] * other - other_s[:, None] * edge
    length_u = np.linalg.norm(along_u, axis=1)
    length_v = np.linalg.norm(along_v, axis=1)
    flat = (
        (edge == 0).all(axis=1)
        | (other == 0).all(axis=1)
        | (edge == other).all(axis=1)
    )
    blank = (np.abs(area) <= _ZERO) | (
        np.minimum(length_u, length_v) <= _ZERO * np.abs(area)
    )
    sign = np.where(upright, 1.0, -1.0)[:, None]
    return _Faces(sign * normalise(along_u), upright, flat, blank)


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
    """What each corner (T, 3) adds to its group's tangent, a vector."""
    along_u = normalise(_project(faces.along_u[:, None], normals))
    following = np.roll(points, -1, axis=1) - points
    preceding = np.roll(points, 1, axis=1) - points
    cosine = (
        normalise(_project(following, normals))
        * normalise(_project(preceding, normals))
    ).sum(axis=-1)
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    angle[faces.flat | faces.blank] = 0.0
    return np.asarray(angle[..., None] * along_u)


def _project(vectors: Array, normals: Array) -> Array:
    """The parts of ``vectors`` across unit ``normals``."""
    along = (vectors * normals).sum(axis=-1, keepdims=True)
    return np.asarray(vectors - along * normals)


def _unit_across(vectors: Array, normals: NDArray[np.float32]) -> Array:
    """Unit vectors; where there is no direction, any across the normal."""
    units = normalise(normals)
    axis = np.eye(3)[np.abs(units).argmin(axis=-1)]
    none = (np.abs(vectors) <= _ZERO).all(axis=-1, keepdims=True)
    return normalise(np.where(none, _project(axis, units), vectors))
