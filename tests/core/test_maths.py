"""Rotations, affine matrices and boxes against formulas and SciPy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from moka.core import maths

numbers = st.floats(-10, 10, width=32)
vectors = arrays(np.float64, 3, elements=numbers)
matrices = arrays(np.float64, (3, 3), elements=numbers)
rotations = st.integers(0, 2**32 - 1).map(
    lambda seed: Rotation.random(rng=np.random.default_rng(seed)).as_quat()
)


def affine(linear: np.ndarray, translation: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    matrix[:3, 3] = translation
    return matrix


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_normalise_works_for_any_length(size: float) -> None:
    assert_allclose(maths.normalise([3 * size, 0, -4 * size]), [0.6, 0, -0.8])


def test_zero_vector_stays_zero() -> None:
    result = maths.normalise([[0, 0, 0], [0, 2, 0]])
    assert result.tolist() == [[0, 0, 0], [0, 1, 0]]


@given(rotations, st.floats(1e-3, 1e3))
def test_quaternion_matrix_is_that_of_scipy(
    quaternion: np.ndarray, length: float
) -> None:
    matrix = maths.quaternion_to_matrix(length * quaternion)
    assert_allclose(
        matrix, Rotation.from_quat(quaternion).as_matrix(), atol=1e-14
    )


def test_zero_quaternion_is_no_rotation() -> None:
    assert_allclose(maths.quaternion_to_matrix(np.zeros(4)), np.eye(3))


@given(rotations)
def test_quaternion_round_trip(quaternion: np.ndarray) -> None:
    matrix = maths.quaternion_to_matrix(quaternion)
    result = maths.matrix_to_quaternion(matrix)
    assert result[3] >= 0
    sign = np.sign(result @ quaternion)
    assert_allclose(result, sign * quaternion, atol=1e-14)


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_have_a_quaternion(axis: int) -> None:
    """Where w is zero and the sum of the diagonal tells nothing."""
    quaternion = np.eye(4)[axis]
    matrix = maths.quaternion_to_matrix(quaternion)
    assert_allclose(np.abs(maths.matrix_to_quaternion(matrix)), quaternion)


@given(rotations, rotations)
def test_product_turns_by_the_second_first(
    first: np.ndarray, second: np.ndarray
) -> None:
    product = maths.multiply_quaternions(first, second)
    assert_allclose(
        maths.quaternion_to_matrix(product),
        maths.quaternion_to_matrix(first) @ maths.quaternion_to_matrix(second),
        atol=1e-14,
    )


def test_quarter_turn_about_y_takes_z_to_x() -> None:
    quaternion = maths.quaternion_about_axis([0, 5, 0], np.pi / 2)
    matrix = maths.quaternion_to_matrix(quaternion)
    assert_allclose(matrix @ [0, 0, 1], [1, 0, 0], atol=1e-15)


def test_compose_scales_then_rotates_then_translates() -> None:
    quarter = maths.quaternion_about_axis([0, 1, 0], np.pi / 2)
    matrix = maths.compose([1, 2, 3], quarter, [10, 20, 30])
    assert_allclose(matrix @ [0, 0, 1, 1], [31, 2, 3, 1], atol=1e-13)


def test_compose_broadcasts_its_leading_axes() -> None:
    matrix = maths.compose(np.zeros((5, 3)), [0, 0, 0, 1], [1, 2, 3])
    assert matrix.shape == (5, 4, 4)
    assert_allclose(matrix[4], np.diag([1, 2, 3, 1]))


@given(vectors, rotations, vectors)
def test_decompose_is_undone_by_compose(
    translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray
) -> None:
    """For every sign of the scale and for zeros in it."""
    matrix = maths.compose(translation, rotation, scale)
    parts = maths.decompose(matrix)
    assert_allclose(np.linalg.norm(parts[1]), 1)
    assert (parts[2][:2] >= 0).all()
    assert (parts[2][2] < 0) == (np.prod(np.sign(scale)) < 0)
    assert_allclose(maths.compose(*parts), matrix, atol=1e-12)


@given(rotations, st.integers(0, 2))
def test_one_zero_scale_keeps_the_rotation(
    rotation: np.ndarray, axis: int
) -> None:
    scale = np.ones(3)
    scale[axis] = 0
    _, found, _ = maths.decompose(maths.compose(np.zeros(3), rotation, scale))
    assert_allclose(abs(found @ rotation), 1, atol=1e-12)


def test_zero_matrix_has_no_rotation() -> None:
    _, rotation, scale = maths.decompose(np.zeros((4, 4)))
    assert rotation.tolist() == [0, 0, 0, 1]
    assert scale.tolist() == [0, 0, 0]


@pytest.mark.parametrize("size", [1e-100, 1.0, 1e100])
@given(linear=matrices)
def test_rotation_and_stretch_rebuild_any_matrix(
    size: float, linear: np.ndarray
) -> None:
    rotation, stretch = maths.rotation_and_stretch(size * linear)
    assert_allclose(stretch, np.triu(stretch))
    assert_allclose(
        maths.quaternion_to_matrix(rotation) @ stretch,
        size * linear,
        atol=1e-10 * size,
    )


@given(vectors, vectors)
def test_look_rotation_is_a_rotation_with_minus_z_forward(
    forward: np.ndarray, up: np.ndarray
) -> None:
    if not forward.any():
        forward = np.array([0, -1, 0])
    matrix = maths.look_rotation(forward, up)
    assert_allclose(matrix.T @ matrix, np.eye(3), atol=1e-12)
    assert_allclose(np.linalg.det(matrix), 1)
    assert_allclose(-matrix[:, 2], maths.normalise(forward), atol=1e-12)
    if np.linalg.norm(np.cross(forward, up)) > 1e-3:
        assert matrix[:, 1] @ up > 0
        assert_allclose(matrix[:, 0] @ maths.normalise(up), 0, atol=1e-9)


@pytest.mark.parametrize("forward", [(0, -1, 0), (0, 1, 0)])
def test_looking_along_up_keeps_x(forward: tuple[int, int, int]) -> None:
    matrix = maths.look_rotation(forward, (0, 1, 0))
    assert_allclose(matrix[:, 0], [1, 0, 0])


@given(rotations, arrays(np.float64, 3, elements=st.floats(0, 9)))
def test_forward_is_the_turned_minus_z_at_any_scale(
    rotation: np.ndarray, scale: np.ndarray
) -> None:
    scale[:2] += 0.1
    matrix = maths.compose([[1, 2, 3]], rotation, scale)
    forward = Rotation.from_quat(rotation).apply([0, 0, -1])
    result = maths.forward_directions(matrix)
    assert_allclose(result, [forward], atol=1e-12)


@given(vectors, rotations, arrays(np.float64, 3, elements=st.floats(0.1, 9)))
def test_inverse_of_affine(
    translation: np.ndarray, rotation: np.ndarray, scale: np.ndarray
) -> None:
    matrix = maths.compose(translation, rotation, scale)
    assert_allclose(
        maths.invert_affine(matrix[None])[0] @ matrix, np.eye(4), atol=1e-11
    )


def test_flat_matrix_has_no_inverse() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        maths.invert_affine(np.diag([1.0, 0, 1, 1]))


@given(matrices)
def test_cofactors_times_transpose_are_the_determinant(
    linear: np.ndarray,
) -> None:
    assert_allclose(
        maths.cofactor_matrix(linear) @ linear.T,
        np.linalg.det(linear) * np.eye(3),
        atol=1e-9,
    )


@given(matrices)
def test_normals_stay_across_their_surface(linear: np.ndarray) -> None:
    """And on the same side of it, mirrored or not, at any scale."""
    if abs(np.linalg.det(linear)) < 1e-2:
        return
    normals = maths.normal_matrix(1e-30 * linear)
    assert_allclose(np.abs(normals).max(), 1)
    expected = np.linalg.inv(linear).T
    assert_allclose(
        normals / np.abs(normals).max(),
        expected / np.abs(expected).max(),
        atol=1e-9,
    )


def test_flat_scale_has_a_normal_matrix() -> None:
    matrix = maths.normal_matrix(np.diag([2.0, 0, 3, 1]))
    assert_allclose(matrix @ [0, 1, 0], [0, 1, 0])


def test_mirrored_means_an_odd_number_of_negative_scales() -> None:
    scales = np.array([[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [0, -1, 1]])
    result = maths.is_mirrored(maths.compose(0 * scales, [0, 0, 0, 1], scales))
    assert result.tolist() == [False, True, False, False]


def test_column_major_puts_the_translation_last() -> None:
    matrix = affine(np.eye(3), np.array([1, 2, 3]))
    flat = np.frombuffer(maths.column_major(matrix).tobytes(), np.float32)
    assert flat[12:].tolist() == [1, 2, 3, 1]


@given(matrices, vectors, vectors, vectors)
def test_transformed_bounds_hold_exactly_the_corners(
    linear: np.ndarray, offset: np.ndarray, one: np.ndarray, two: np.ndarray
) -> None:
    bounds = np.sort([one, two], axis=0)
    corners = np.array(
        [
            linear @ [x, y, z] + offset
            for x in bounds[:, 0]
            for y in bounds[:, 1]
            for z in bounds[:, 2]
        ]
    )
    expected = [corners.min(axis=0), corners.max(axis=0)]
    result = maths.transform_bounds(affine(linear, offset), bounds)
    assert_allclose(result, expected, atol=1e-11)


def test_union_holds_every_box() -> None:
    boxes = [[[0, 0, 0], [1, 1, 1]], [[-1, 0.5, 0], [0, 2, 0]]]
    assert maths.union_bounds(boxes).tolist() == [[-1, 0, 0], [1, 2, 1]]
