"""Built-in shapes: closed, outward, textured the right way round."""

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model import (
    Primitive,
    cube,
    quad,
    sphere,
    triangle_corners,
    with_tangents,
)


def corners(primitive: Primitive, name: str) -> np.ndarray:
    array = primitive.attributes[name][triangle_corners(primitive)]
    return array.astype(np.float64)


def areas(primitive: Primitive) -> np.ndarray:
    """Vectors along the faces, twice as long as the areas."""
    a, b, c = np.moveaxis(corners(primitive, "POSITION"), 1, 0)
    return np.cross(b - a, c - a)


SHAPES = [cube(2), quad(3), sphere(1.5), sphere(1, 3, 2), sphere(1, 16, 5)]


@pytest.mark.parametrize("shape", SHAPES)
def test_faces_look_where_their_normals_do(shape: Primitive) -> None:
    facing = (corners(shape, "NORMAL") * areas(shape)[:, None]).sum(axis=-1)
    assert (facing > 0).all()
    lengths = np.linalg.norm(shape.attributes["NORMAL"], axis=1)
    np.testing.assert_allclose(lengths, 1, atol=1e-6)


@pytest.mark.parametrize("shape", SHAPES)
def test_textures_are_not_mirrored(shape: Primitive) -> None:
    """Seen from the front u runs right and v down, so that areas differ in
    sign from those of the plane."""
    a, b, c = np.moveaxis(corners(shape, "TEXCOORD_0"), 1, 0)
    s, t = b - a, c - a
    assert (s[:, 0] * t[:, 1] - s[:, 1] * t[:, 0] < 0).all()
    assert (with_tangents(shape).attributes["TANGENT"][:, 3] == 1).all()


@pytest.mark.parametrize("shape", [SHAPES[0], *SHAPES[2:]])
def test_solids_are_closed(shape: Primitive) -> None:
    """Every edge is walked once each way, positions compared exactly."""
    points = {}
    names = [
        [points.setdefault(tuple(point), len(points)) for point in triangle]
        for triangle in corners(shape, "POSITION").tolist()
    ]
    edges = [
        (triangle[i], triangle[(i + 1) % 3])
        for triangle in names
        for i in range(3)
    ]
    assert len(set(edges)) == len(edges)
    assert {(b, a) for a, b in edges} == set(edges)


def test_cube_and_quad_have_their_sizes() -> None:
    assert [bound.tolist() for bound in cube(2).bounds] == [[-1] * 3, [1] * 3]
    assert np.linalg.norm(areas(cube(2)), axis=1).sum() / 2 == 24
    assert [bound.tolist() for bound in quad(2).bounds] == [
        [-1, -1, 0],
        [1, 1, 0],
    ]
    assert quad().attributes["NORMAL"].tolist() == [[0, 0, 1]] * 4


def test_the_sphere_is_round_and_its_texture_a_map() -> None:
    shape = sphere(2, 96, 48)
    position, uv = shape.attributes["POSITION"], shape.attributes["TEXCOORD_0"]
    np.testing.assert_allclose(np.linalg.norm(position, axis=1), 2, rtol=1e-6)
    np.testing.assert_allclose(position, 2 * shape.attributes["NORMAL"])
    polar = np.pi * uv[:, 1]
    np.testing.assert_allclose(position[:, 1], 2 * np.cos(polar), atol=1e-6)
    off_pole = np.abs(position[:, 1]) < 1.999
    longitude = np.arctan2(position[:, 0], position[:, 2]) / (2 * np.pi)
    difference = (longitude - uv[:, 0] + 0.5)[off_pole] % 1 - 0.5
    np.testing.assert_allclose(difference, 0, atol=1e-6)
    total = np.linalg.norm(areas(shape), axis=1).sum() / 2
    assert total == pytest.approx(16 * np.pi, rel=2e-3)
    assert shape.element_count == 2 * 96 * 47


@pytest.mark.parametrize("size", [0, -1, float("nan"), float("inf")])
def test_sizes_must_be_positive(size: float) -> None:
    for make in (cube, quad, sphere):
        with pytest.raises(ModelError, match="positive and finite"):
            make(size)


def test_a_sphere_needs_segments() -> None:
    with pytest.raises(ModelError, match="3 segments and 2 rings, not 2 and 2"):
        sphere(1, 2, 2)
