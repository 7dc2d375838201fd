"""The handle on one transform against GLM and against geometry."""

import math
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pyglm import glm

from moka.core.errors import OptionError
from moka.core.maths import compose, normalise
from moka.scene.transform import Transform
from moka.scene.transforms import TransformTree

coordinates = st.floats(-50, 50, width=32)
points = st.tuples(coordinates, coordinates, coordinates)
angles = st.floats(-10, 10)
directions = points.filter(lambda point: math.hypot(*point) > 1e-3)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(
    lambda quaternion: math.hypot(*quaternion) > 1e-3
)
scales = st.tuples(*[st.sampled_from([-2.0, 0.5, 1.0, 3.0])] * 3)


def glm_matrix(position: Any, rotation: Any, scale: Any) -> Any:
    x, y, z, w = rotation
    turn = glm.mat4_cast(glm.normalize(glm.dquat(w, x, y, z)))
    move = glm.translate(glm.dvec3(*position))
    return move * turn * glm.scale(glm.dvec3(*scale))


@given(points, quaternions, scales)
def test_matrix_is_translation_rotation_scale(
    position: Any, rotation: Any, scale: Any
) -> None:
    transform = Transform(position, rotation, scale)
    expected = np.asarray(glm_matrix(position, rotation, scale))
    assert_allclose(transform.local_matrix, expected, atol=1e-12)
    assert_allclose(transform.world_matrix, expected, atol=1e-12)
    single = np.asarray(transform.to_matrix())
    assert_allclose(single, expected, rtol=1e-5, atol=1e-12)


def test_default_is_the_identity() -> None:
    assert_allclose(Transform().local_matrix, np.eye(4))


@given(points, quaternions, scales)
def test_parts_come_back_as_pyglm_values(
    position: Any, rotation: Any, scale: Any
) -> None:
    transform = Transform(position, rotation, scale)
    assert transform.position == glm.vec3(position)
    assert transform.scale == glm.vec3(scale)
    assert isinstance(transform.rotation, glm.quat)
    x, y, z, w = normalise(rotation)
    assert_allclose(list(transform.rotation), [w, x, y, z], atol=1e-6)


def test_pyglm_values_and_sequences_mean_the_same() -> None:
    half = math.sqrt(0.5)
    one = Transform(glm.vec3(1, 2, 3), glm.quat(half, 0, half, 0), 2)
    two = Transform(np.array([1, 2, 3]), (0, half, 0, half), glm.dvec3(2, 2, 2))
    assert_allclose(one.local_matrix, two.local_matrix, atol=1e-6)
    assert_allclose(one.local_matrix[:3, 0], [0, 0, -2], atol=1e-6)


def test_pyglm_arithmetic_works_on_the_parts() -> None:
    transform = Transform()
    transform.position += glm.vec3(0, 2, 0)
    transform.rotation = transform.rotation * glm.angleAxis(
        math.pi, glm.vec3(0, 1, 0)
    )
    assert transform.position == glm.vec3(0, 2, 0)
    assert_allclose(np.asarray(transform.forward), [0, 0, 1], atol=1e-6)


def test_far_positions_keep_double_precision() -> None:
    transform = Transform((1e7 + 0.125, 0, 0))
    transform.translate((1e-6, 0, 0))
    assert transform.world_matrix[0, 3] == 1e7 + 0.125 + 1e-6


@given(points, quaternions)
def test_directions_are_the_turned_axes(position: Any, rotation: Any) -> None:
    transform = Transform(position, rotation, (2, 3, 4))
    axes = normalise(transform.local_matrix[:3, :3].T)
    assert_allclose(np.asarray(transform.right), axes[0], atol=1e-6)
    assert_allclose(np.asarray(transform.up), axes[1], atol=1e-6)
    assert_allclose(np.asarray(transform.forward), -axes[2], atol=1e-6)


@given(points, points, directions)
def test_look_at_is_the_inverse_of_glms_view(
    position: Any, target: Any, up: Any
) -> None:
    forward = np.subtract(target, position)
    if np.linalg.norm(np.cross(forward, up)) < 1e-2:
        return
    transform = Transform(position)
    transform.look_at(target, up)
    view = glm.lookAt(glm.dvec3(*position), glm.dvec3(*target), glm.dvec3(*up))
    expected = np.asarray(glm.inverse(view))
    assert_allclose(transform.local_matrix, expected, atol=1e-9)


@pytest.mark.parametrize("target", [(1, 9, 3), (1, -9, 3)])
def test_look_straight_up_and_down(target: Any) -> None:
    transform = Transform((1, 2, 3))
    transform.look_at(target)
    forward = normalise(np.subtract(target, (1, 2, 3)))
    assert_allclose(np.asarray(transform.forward), forward, atol=1e-7)
    assert_allclose(np.asarray(transform.right), [1, 0, 0], atol=1e-7)


@given(points, quaternions, scales, points, points)
def test_look_at_finds_a_target_in_the_world_from_below_a_parent(
    place: Any, turn: Any, size: Any, position: Any, target: Any
) -> None:
    """Also if the parent squeezes or mirrors the space."""
    child = Transform(position)
    child.set_parent(Transform(place, turn, size))
    eye = child.world_matrix[:3, 3]
    if np.linalg.norm(target - eye) < 1e-2:
        return
    child.look_at(target)
    axis = normalise(-child.world_matrix[:3, 2])
    assert_allclose(axis, normalise(target - eye), atol=1e-9)


def test_look_at_its_own_position_is_an_error() -> None:
    with pytest.raises(OptionError, match="own position"):
        Transform((1, 2, 3)).look_at((1, 2, 3))


@given(points, quaternions, points, directions, angles)
def test_rotate_around_multiplies_from_the_left(
    position: Any, rotation: Any, point: Any, axis: Any, angle: float
) -> None:
    transform = Transform(position, rotation, (1, 2, 3))
    before = transform.local_matrix
    transform.rotate_around(point, axis, angle)
    move = glm.translate(glm.dvec3(*point))
    turn = glm.rotate(angle, glm.normalize(glm.dvec3(*axis)))
    back = glm.translate(-glm.dvec3(*point))
    expected = np.asarray(move * turn * back) @ before
    assert_allclose(transform.local_matrix, expected, atol=1e-9)


def test_rotate_around_moves_and_turns() -> None:
    transform = Transform((0, 0, 1))
    transform.rotate_around((0, 0, 0), (0, 1, 0), math.pi / 2)
    assert_allclose(list(transform.position), [1, 0, 0], atol=1e-7)
    assert_allclose(list(transform.forward), [-1, 0, 0], atol=1e-7)


def test_many_turns_do_not_change_the_size() -> None:
    transform = Transform((0, 0, 2))
    for _ in range(2000):
        transform.rotate_around((0, 0, 0), (1, 2, 3), 0.1)
    linear = transform.local_matrix[:3, :3]
    assert_allclose(linear.T @ linear, np.eye(3), atol=1e-14)
    assert_allclose(math.hypot(*transform.local_matrix[:3, 3]), 2)


@given(points, quaternions, directions, angles)
def test_rotate_turns_on_the_spot(
    position: Any, rotation: Any, axis: Any, angle: float
) -> None:
    transform = Transform(position, rotation)
    other = Transform(position, rotation)
    transform.rotate(axis, angle)
    other.rotate_around(position, axis, angle)
    assert_allclose(transform.local_matrix, other.local_matrix, atol=1e-9)


def test_zero_scale_does_not_forget_the_rotation() -> None:
    transform = Transform((1, 2, 3), (1, 2, 3, 4))
    before = transform.local_matrix
    transform.scale = 0
    assert_allclose(transform.local_matrix[:3, :3], 0)
    transform.rotate((0, 1, 0), 0.5)
    transform.rotate((0, 1, 0), -0.5)
    transform.set_parent(Transform())
    transform.scale = 1
    assert_allclose(transform.local_matrix, before, atol=1e-12)


def test_shear_survives_moving_and_turning() -> None:
    matrix = np.eye(4)
    matrix[0, 1] = 0.5
    transform = Transform.from_matrix(matrix)
    transform.translate((1, 0, 0))
    transform.rotate((0, 0, 1), math.pi / 2)
    expected = [[0, -1, 0, 1], [1, 0.5, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    assert_allclose(transform.local_matrix, expected, atol=1e-12)


def test_matrix_of_pyglm_is_taken_the_right_way_round() -> None:
    transform = Transform.from_matrix(glm.translate(glm.vec3(1, 2, 3)))
    assert transform.position == glm.vec3(1, 2, 3)


def test_handles_of_one_row_see_each_other() -> None:
    tree = TransformTree()
    row = tree.add()
    transform = Transform.of_row(tree, row)
    assert Transform.of_row(tree, row) is transform
    assert transform.position == glm.vec3(0)
    tree.set_local(row, compose([4, 5, 6], [0, 0, 0, 1], [1, 1, 1]))
    assert transform.position == glm.vec3(4, 5, 6)


@given(points, quaternions, points, quaternions, scales)
def test_keeping_the_world_moves_nothing(
    place: Any, turn: Any, position: Any, rotation: Any, scale: Any
) -> None:
    parent = Transform(place, turn, scale)
    child = Transform(position, rotation, (1, 2, 3))
    before = child.world_matrix
    child.set_parent(parent, keep_world=True)
    assert child.parent is parent
    assert_allclose(child.world_matrix, before, atol=1e-9)
    child.set_parent(None, keep_world=True)
    assert child.parent is None
    assert_allclose(child.world_matrix, before, atol=1e-9)


@given(points, quaternions, scales, points, quaternions)
def test_world_matrix_can_be_set(
    place: Any, turn: Any, size: Any, position: Any, rotation: Any
) -> None:
    child = Transform()
    child.set_parent(Transform(place, turn, size))
    world = compose(position, rotation, (1, 2, 3))
    child.world_matrix = world
    assert_allclose(child.world_matrix, world, atol=1e-9)


def test_without_keeping_the_world_the_local_matrix_stays() -> None:
    child = Transform((1, 0, 0))
    child.set_parent(Transform((0, 5, 0), scale=2))
    assert child.position == glm.vec3(1, 0, 0)
    assert_allclose(child.world_matrix[:3, 3], [2, 5, 0])


def test_families_join_whoever_is_named_first() -> None:
    """Handles follow their rows from tree to tree."""
    scene = TransformTree(fixed=True)
    model = Transform.of_row(scene, scene.add())
    pivot, arm, camera = (Transform((i, 0, 0)) for i in (1, 2, 4))
    camera.set_parent(arm)
    model.set_parent(pivot)
    arm.set_parent(model)
    assert camera.tree is arm.tree is pivot.tree is model.tree is scene
    assert camera.parent is arm
    assert camera.world_matrix[0, 3] == 7


def test_scenes_do_not_mix() -> None:
    one, two = TransformTree(fixed=True), TransformTree(fixed=True)
    child = Transform.of_row(one, one.add())
    parent = Transform.of_row(two, two.add())
    with pytest.raises(OptionError, match="another scene"):
        child.set_parent(parent)


def test_circles_are_refused_and_change_nothing() -> None:
    one, two = Transform((1, 0, 0)), Transform((2, 0, 0))
    two.set_parent(one)
    with pytest.raises(OptionError, match="ancestor"):
        one.set_parent(two, keep_world=True)
    assert_allclose(two.world_matrix[0, 3], 3)


def test_removed_rows_say_so() -> None:
    tree = TransformTree()
    transform = Transform.of_row(tree, tree.add())
    tree.remove(np.array([transform.row]))
    with pytest.raises(OptionError, match="after its model was removed"):
        _ = transform.position
    assert "removed" in repr(transform)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("position", (1, 2), "position needs 3 finite numbers"),
        ("position", 5, "position needs 3"),
        ("position", (1, 2, math.nan), "position needs 3"),
        ("position", "abc", "position needs 3"),
        ("rotation", (0, 0, 0), "rotation needs 4"),
        ("rotation", (0, 0, 0, 0), "must not be zero"),
        ("rotation", glm.quat(0, 0, 0, 0), "must not be zero"),
        ("scale", (1, math.inf, 1), "scale needs 3"),
        ("scale", math.nan, "scale needs 3"),
    ],
)
def test_nonsense_is_named(name: str, value: Any, message: str) -> None:
    transform = Transform()
    with pytest.raises(OptionError, match=message):
        setattr(transform, name, value)
    assert_allclose(transform.local_matrix, np.eye(4))


def test_errors_are_one_line() -> None:
    with pytest.raises(OptionError) as caught:
        Transform(np.zeros((3, 3)))
    assert "\n" not in str(caught.value)


def test_axis_and_angle_must_mean_something() -> None:
    with pytest.raises(OptionError, match="axis must not be zero"):
        Transform().rotate((0, 0, 0), 1)
    with pytest.raises(OptionError, match="an angle needs 1 finite number"):
        Transform().rotate((0, 1, 0), math.inf)


def test_parent_of_scale_zero_has_no_inside() -> None:
    child = Transform()
    parent = Transform(scale=0)
    with pytest.raises(OptionError, match="scale 0"):
        child.set_parent(parent, keep_world=True)
    assert child.parent is None
    child.set_parent(parent)
    with pytest.raises(OptionError, match="scale 0"):
        child.look_at((1, 2, 3))


def test_nothing_heavy_is_imported() -> None:
    code = (
        "import sys, moka.scene.transform as t; t.Transform();"
        "assert not {'pyglm', 'moderngl'} & sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
