"""Built-in shapes: a cube, a quad and a sphere.

All have normals and TEXCOORD_0 with v downwards, front faces anticlockwise
seen from outside, and textures the right way round: u runs to the right for
an observer who looks at the front with +Y up.
"""

import numpy as np
from numpy.typing import ArrayLike

from moka.core.errors import ModelError
from moka.model.mesh import Primitive

__all__ = ["cube", "quad", "sphere"]

# Outward normal of each side, and where u points on it.
_SIDES = np.array(
    [
        [(1, 0, 0), (0, 0, -1)],
        [(-1, 0, 0), (0, 0, 1)],
        [(0, 1, 0), (1, 0, 0)],
        [(0, -1, 0), (1, 0, 0)],
        [(0, 0, 1), (1, 0, 0)],
        [(0, 0, -1), (-1, 0, 0)],
    ],
    np.float64,
)


def cube(size: float = 1.0) -> Primitive:
    """A cube of edge ``size`` metres around the origin.

    24 vertices, each side with the whole texture. Raises ModelError unless
    ``size`` is positive and finite.
    """
    _check_size("size", size)
    return _sides(_SIDES[:, 0], _SIDES[:, 1], size, offset=size / 2)


def quad(size: float = 1.0) -> Primitive:
    """A square of edge ``size`` metres in the plane z = 0, facing +Z.

    Raises ModelError unless ``size`` is positive and finite.
    """
    _check_size("size", size)
    return _sides([(0, 0, 1)], [(1, 0, 0)], size, offset=0.0)


def sphere(
    radius: float = 0.5, segments: int = 48, rings: int = 24
) -> Primitive:
    """A sphere around the origin, of meridians and parallels.

    ``segments`` triangles go round the equator (at least 3), ``rings`` from
    pole to pole (at least 2). The texture is an equirectangular map with +Z
    at its left and right edges. Raises ModelError for other numbers.
    """
    _check_size("radius", radius)
    if segments < 3 or rings < 2:
        raise ModelError(
            f"a sphere needs 3 segments and 2 rings, not {segments} and {rings}"
        )
    column = np.arange(segments + 1)
    row = np.arange(rings + 1)[:, None]
    # The last column lies exactly on the first and the poles are exactly
    # points, so that the surface is closed and tangents are continuous.
    longitude = 2 * np.pi * (column % segments) / segments
    across = np.sin(np.pi * row / rings) * (row % rings > 0)
    normals = np.stack(
        np.broadcast_arrays(
            across * np.sin(longitude),
            np.cos(np.pi * row / rings),
            across * np.cos(longitude),
        ),
        axis=-1,
    ).reshape(-1, 3)
    # A pole has a vertex for each of its triangles, in the middle of its u.
    u = (column + 0.5 * (row % rings == 0)) / segments
    uv = np.stack(np.broadcast_arrays(u, row / rings), axis=-1)
    upper_left = (row[:-1] * (segments + 1) + column[:-1]).reshape(-1)
    lower_left = upper_left + segments + 1
    above = np.stack([upper_left, lower_left, upper_left + 1], axis=-1)
    below = np.stack([upper_left + 1, lower_left, lower_left + 1], axis=-1)
    # Triangles without area at the poles are left out, those that remain
    # take the pole's vertex of their own column.
    below[:segments, 0] -= 1
    triangles = np.concatenate([above[segments:], below[:-segments]])
    return Primitive(
        {
            "POSITION": radius * normals,
            "NORMAL": normals,
            "TEXCOORD_0": uv.reshape(-1, 2),
        },
        triangles.reshape(-1),
    )


def _sides(
    normals: ArrayLike, rights: ArrayLike, size: float, offset: float
) -> Primitive:
    """Squares that stand ``offset`` away from the origin along normals."""
    normal = np.asarray(normals, np.float64)
    right = np.asarray(rights, np.float64)
    up = np.cross(normal, right)
    uv = np.array([(0, 1), (1, 1), (1, 0), (0, 0)], np.float64)
    x, y = uv[:, 0] - 0.5, 0.5 - uv[:, 1]
    position = offset * normal[:, None] + size * (
        x[:, None] * right[:, None] + y[:, None] * up[:, None]
    )
    first = 4 * np.arange(len(normal))[:, None]
    corners = np.array([0, 1, 2, 0, 2, 3])
    return Primitive(
        {
            "POSITION": position.reshape(-1, 3),
            "NORMAL": np.repeat(normal, 4, axis=0),
            "TEXCOORD_0": np.tile(uv, (len(normal), 1)),
        },
        (first + corners).reshape(-1),
    )


def _check_size(name: str, value: float) -> None:
    if not 0 < value < np.inf:
        raise ModelError(f"{name} must be positive and finite, not {value}")
