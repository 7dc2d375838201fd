"""MikkTSpace, one triangle after the other: an oracle for tangents.

Follows the published algorithm step by step in float64, for triangles, with
the default threshold: faces are joined into groups around each vertex by
walking across their edges. Nothing of the vectorised version is used.
"""

import math
from dataclasses import dataclass, field

Vector = tuple[float, ...]
TINY = 1.1754943508222875e-38  # the least normal float32


def subtract(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def dot(a: Vector, b: Vector) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def combine(p: float, a: Vector, q: float, b: Vector) -> Vector:
    return tuple(p * x + q * y for x, y in zip(a, b, strict=True))


def unit(a: Vector) -> Vector:
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a) if length > TINY else a


def across(a: Vector, normal: Vector) -> Vector:
    return unit(combine(1.0, a, -dot(a, normal), normal))


@dataclass
class Face:
    """A triangle: its welded vertices and what they say of the texture."""

    vertices: tuple[int, int, int]
    along_u: Vector
    upright: bool
    blank: bool
    flat: bool
    neighbours: list[tuple[int, int] | None] = field(
        default_factory=lambda: [None] * 3
    )
    groups: list[int | None] = field(default_factory=lambda: [None] * 3)


@dataclass
class Group:
    vertex: int
    upright: bool
    faces: list[int] = field(default_factory=list)


def corner_tangents(
    positions: list[Vector],
    normals: list[Vector],
    uvs: list[Vector],
    triangles: list[tuple[int, int, int]],
) -> list[list[tuple[Vector, float] | None]]:
    """For each corner of each triangle the tangent and w, None without one.

    ``uvs`` have v downwards, as glTF's; w is 1 where the texture is not
    mirrored.
    """
    welded: dict[tuple[Vector, ...], int] = {}
    names = [
        welded.setdefault(vertex, len(welded))
        for vertex in zip(positions, normals, uvs, strict=True)
    ]
    faces = [make_face(positions, uvs, names, each) for each in triangles]
    join_neighbours(faces)
    groups = make_groups(faces)
    tangents = {
        number: group_tangent(
            group,
            [faces[index] for index in group.faces],
            [[positions[i] for i in triangles[index]] for index in group.faces],
            [[normals[i] for i in triangles[index]] for index in group.faces],
        )
        for number, group in enumerate(groups)
    }
    return [
        [resolve(face, corner, faces, tangents) for corner in range(3)]
        for face in faces
    ]


def make_face(
    positions: list[Vector],
    uvs: list[Vector],
    names: list[int],
    triangle: tuple[int, int, int],
) -> Face:
    p0, p1, p2 = (positions[i] for i in triangle)
    (s0, t0), (s1, t1), (s2, t2) = ((uvs[i][0], -uvs[i][1]) for i in triangle)
    d1, d2 = subtract(p1, p0), subtract(p2, p0)
    s1, t1, s2, t2 = s1 - s0, t1 - t0, s2 - s0, t2 - t0
    area = s1 * t2 - t1 * s2
    along_u = combine(t2, d1, -t1, d2)
    along_v = combine(-s2, d1, s1, d2)
    lengths = [math.sqrt(dot(a, a)) for a in (along_u, along_v)]
    blank = abs(area) <= TINY or min(lengths) / abs(area) <= TINY
    sign = 1.0 if area > 0 else -1.0
    return Face(
        vertices=tuple(names[i] for i in triangle),  # type: ignore[arg-type]
        along_u=tuple(sign * x for x in unit(along_u)),
        upright=area > 0,
        blank=blank,
        flat=p0 in (p1, p2) or p1 == p2,
    )


def join_neighbours(faces: list[Face]) -> None:
    """Pair edges that two faces walk in opposite directions, in order."""
    for index, face in enumerate(faces):
        for edge in range(3):
            if face.flat or face.neighbours[edge] is not None:
                continue
            start, end = face.vertices[edge], face.vertices[(edge + 1) % 3]
            for other_index in range(index + 1, len(faces)):
                other = faces[other_index]
                for other_edge in range(3):
                    if (
                        face.neighbours[edge] is None
                        and not other.flat
                        and other.neighbours[other_edge] is None
                        and other.vertices[other_edge] == end
                        and other.vertices[(other_edge + 1) % 3] == start
                    ):
                        face.neighbours[edge] = other_index, other_edge
                        other.neighbours[other_edge] = index, edge


def make_groups(faces: list[Face]) -> list[Group]:
    groups: list[Group] = []
    for index, face in enumerate(faces):
        for corner in range(3):
            if face.flat or face.blank or face.groups[corner] is not None:
                continue
            group = Group(face.vertices[corner], face.upright)
            groups.append(group)
            grow(faces, index, group, len(groups) - 1)
    return groups


def grow(faces: list[Face], index: int, group: Group, number: int) -> None:
    face = faces[index]
    corner = face.vertices.index(group.vertex)
    if face.groups[corner] is not None:
        return
    if face.blank and face.groups == [None] * 3:
        face.upright = group.upright
    if face.upright != group.upright:
        return
    face.groups[corner] = number
    group.faces.append(index)
    for edge in (corner, (corner + 2) % 3):
        neighbour = face.neighbours[edge]
        if neighbour is not None:
            grow(faces, neighbour[0], group, number)


def group_tangent(
    group: Group,
    faces: list[Face],
    points: list[list[Vector]],
    normals: list[list[Vector]],
) -> tuple[Vector, float]:
    total: Vector = (0.0, 0.0, 0.0)
    for face, point, normal in zip(faces, points, normals, strict=True):
        if face.blank:
            continue
        corner = face.vertices.index(group.vertex)
        here = point[corner]
        n = normal[corner]
        first = across(subtract(point[(corner + 2) % 3], here), n)
        second = across(subtract(point[(corner + 1) % 3], here), n)
        angle = math.acos(max(-1.0, min(1.0, dot(first, second))))
        total = combine(1.0, total, angle, across(face.along_u, n))
    return unit(total), 1.0 if group.upright else -1.0


def resolve(
    face: Face,
    corner: int,
    faces: list[Face],
    tangents: dict[int, tuple[Vector, float]],
) -> tuple[Vector, float] | None:
    """A flat face takes what the first whole one has at the same vertex."""
    number = face.groups[corner]
    if face.flat:
        vertex = face.vertices[corner]
        for other in faces:
            if not other.flat and vertex in other.vertices:
                number = other.groups[other.vertices.index(vertex)]
                break
    return None if number is None else tangents[number]
