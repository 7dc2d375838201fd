"""Projections and planes against their definitions."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pyglm import glm

from moka.core.projection import (
    frustum_planes,
    look_at,
    orthographic,
    perspective,
)

RANGES = [(0.1, 100.0), (1e-3, 1e6), (0.5, math.inf)]


def project(matrix: np.ndarray, point: tuple[float, ...]) -> np.ndarray:
    clip = matrix @ [*point, 1]
    return np.asarray(clip[:3] / clip[3])


@pytest.mark.parametrize(("near", "far"), RANGES)
@pytest.mark.parametrize("reversed_z", [False, True])
def test_depth_of_near_and_far(
    near: float, far: float, reversed_z: bool
) -> None:
    matrix = perspective(1.0, 1.5, near, far, reversed_z=reversed_z)
    front, back = (1, 0) if reversed_z else (-1, 1)
    assert_allclose(project(matrix, (0, 0, -near))[2], front, atol=1e-12)
    distance = far if math.isfinite(far) else 1e30
    assert_allclose(project(matrix, (0, 0, -distance))[2], back, atol=1e-12)


@pytest.mark.parametrize("reversed_z", [False, True])
def test_field_of_view_reaches_the_edges(reversed_z: bool) -> None:
    matrix = perspective(1.2, 2.0, 0.1, 10, reversed_z=reversed_z)
    height = 3 * math.tan(0.6)
    corner = project(matrix, (2 * height, height, -3))
    assert_allclose(corner[:2], [1, 1])


def test_classic_forms_are_those_of_glm() -> None:
    near, far = 0.1, 50.0
    assert_allclose(
        perspective(0.9, 1.7, near, far),
        np.asarray(glm.perspectiveRH_NO(0.9, 1.7, near, far)),
        rtol=1e-6,
    )
    assert_allclose(
        orthographic(3, 2, near, far),
        np.asarray(glm.orthoRH_NO(-3, 3, -2, 2, near, far)),
        rtol=1e-6,
    )


@pytest.mark.parametrize("reversed_z", [False, True])
@pytest.mark.parametrize("near", [-5.0, 0.0, 1.0])
def test_orthographic_spans_its_box(near: float, reversed_z: bool) -> None:
    matrix = orthographic(3, 2, near, 9, reversed_z=reversed_z)
    front, back = (1, 0) if reversed_z else (-1, 1)
    assert_allclose(project(matrix, (3, 2, -near)), [1, 1, front])
    assert_allclose(project(matrix, (-3, -2, -9)), [-1, -1, back], atol=1e-15)


coordinates = st.floats(-100, 100)
points = st.tuples(coordinates, coordinates, coordinates)


@given(points, points)
def test_look_at_is_that_of_glm(
    eye: tuple[float, ...], target: tuple[float, ...]
) -> None:
    forward = np.subtract(target, eye)
    if np.linalg.norm(np.cross(forward, (0, 1, 0))) < 1e-3:
        return
    # PyGLM reads a tuple in single precision, separate numbers in double.
    expected = glm.lookAt(
        glm.dvec3(*eye), glm.dvec3(*target), glm.dvec3(0, 1, 0)
    )
    assert_allclose(look_at(eye, target), np.asarray(expected), atol=1e-9)


@pytest.mark.parametrize("reversed_z", [False, True])
@pytest.mark.parametrize(("near", "far"), RANGES)
@given(data=st.data())
def test_planes_hold_what_clip_space_holds(
    near: float, far: float, reversed_z: bool, data: st.DataObject
) -> None:
    matrix = perspective(1.0, 1.5, near, far, reversed_z=reversed_z) @ look_at(
        (3, 1, 2), (0, 0.5, 0)
    )
    point = data.draw(points)
    x, y, z, w = matrix @ [*point, 1]
    inside = (abs(x) <= w) & (abs(y) <= w)
    inside &= 0 <= z <= w if reversed_z else -w <= z <= w
    planes = frustum_planes(matrix, reversed_z=reversed_z)
    distances = planes[:, :3] @ point + planes[:, 3]
    if abs(distances).min() > 1e-6:
        assert inside == (distances >= 0).all()


def test_plane_distances_are_metres() -> None:
    matrix = perspective(math.pi / 2, 1, 0.5, 20, reversed_z=True)
    planes = frustum_planes(matrix, reversed_z=True)
    diagonal = math.sqrt(0.5)
    assert_allclose(planes[0], [diagonal, 0, -diagonal, 0], atol=1e-15)
    assert_allclose(planes[4], [0, 0, -1, -0.5], atol=1e-15)
    assert_allclose(planes[5], [0, 0, 1, 20], atol=1e-15)


@pytest.mark.parametrize("reversed_z", [False, True])
def test_infinite_far_plane_holds_everything(reversed_z: bool) -> None:
    matrix = perspective(1, 1, 0.1, math.inf, reversed_z=reversed_z)
    matrix = matrix @ look_at((1, 2, 3), (5, 4, -7))
    planes = frustum_planes(matrix, reversed_z=reversed_z)
    assert planes[5].tolist() == [0, 0, 0, 1]
