"""Rotations, affine matrices and bounding boxes over whole arrays.

Everything is float64 and vectorised over leading axes. Vectors are columns:
a matrix is indexed [row, column], its translation is the last column, and
``a @ b`` applies ``b`` first. OpenGL reads a matrix column by column; use
:func:`column_major` for bytes that go there. Quaternions are (x, y, z, w), as
in glTF. Space is right-handed with +Y up. Projections and cameras are in
:mod:`moka.core.projection`.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Array",
    "cofactor_matrix",
    "column_major",
    "compose",
    "decompose",
    "forward_directions",
    "invert_affine",
    "is_mirrored",
    "look_rotation",
    "matrix_to_quaternion",
    "multiply_quaternions",
    "normal_matrix",
    "normalise",
    "quaternion_about_axis",
    "quaternion_to_matrix",
    "rotation_and_stretch",
    "transform_bounds",
    "union_bounds",
]

Array = NDArray[np.float64]

_IDENTITY = np.eye(3)
# The axes that come after and before each of three, in their circle.
_AFTER = np.array([1, 2, 0])
_BEFORE = np.array([2, 0, 1])
# Unit vectors whose cross product is shorter are taken for parallel: what is
# left of it is rounding, not a direction.
_PARALLEL = 1e-12


def normalise(vectors: ArrayLike) -> Array:
    """Vectors (..., N) scaled to length 1; the zero vector stays zero.

    Scaling by the largest component first keeps lengths from 1e-300 to
    1e300 from vanishing or overflowing when they are squared.
    """
    vectors = np.asarray(vectors, np.float64)
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    scaled = vectors / np.where(largest > 0, largest, 1)
    length = np.sqrt((scaled * scaled).sum(axis=-1, keepdims=True))
    return _array(scaled / np.where(length > 0, length, 1))


def quaternion_about_axis(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Quaternions (..., 4) that turn by ``angle`` radians about ``axis``.

    Counter-clockwise for an observer whom the axis (..., 3) points at. Its
    length does not matter, but it must not be zero.
    """
    half = 0.5 * np.asarray(angle, np.float64)[..., None]
    vector = np.sin(half) * normalise(axis)
    scalar = np.broadcast_to(np.cos(half), (*vector.shape[:-1], 1))
    return np.concatenate([vector, scalar], axis=-1)


def multiply_quaternions(first: ArrayLike, second: ArrayLike) -> Array:
    """Hamilton product (..., 4): the rotation ``second``, then ``first``."""
    a = np.asarray(first, np.float64)
    b = np.asarray(second, np.float64)
    vector = (
        a[..., 3:] * b[..., :3]
        + b[..., 3:] * a[..., :3]
        + np.cross(a[..., :3], b[..., :3])
    )
    scalar = a[..., 3] * b[..., 3] - (a[..., :3] * b[..., :3]).sum(axis=-1)
    return np.concatenate([vector, scalar[..., None]], axis=-1)


def quaternion_to_matrix(quaternions: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4) of any length.

    The zero quaternion, which is no rotation, gives the identity.
    """
    x, y, z, w = np.moveaxis(normalise(quaternions), -1, 0)
    matrix = np.empty((*x.shape, 3, 3))
    matrix[..., 0, 0] = 1 - 2 * (y * y + z * z)
    matrix[..., 0, 1] = 2 * (x * y - z * w)
    matrix[..., 0, 2] = 2 * (x * z + y * w)
    matrix[..., 1, 0] = 2 * (x * y + z * w)
    matrix[..., 1, 1] = 1 - 2 * (x * x + z * z)
    matrix[..., 1, 2] = 2 * (y * z - x * w)
    matrix[..., 2, 0] = 2 * (x * z - y * w)
    matrix[..., 2, 1] = 2 * (y * z + x * w)
    matrix[..., 2, 2] = 1 - 2 * (x * x + y * y)
    return matrix


def matrix_to_quaternion(matrices: ArrayLike) -> Array:
    """Unit quaternions (..., 4), w >= 0, of rotation matrices (..., 3, 3).

    The matrix gives all products 4 q_i q_j; the row of the largest square is
    the quaternion itself up to its length, found without cancellation
    (Shepperd 1978, "Quaternion from Rotation Matrix").
    """
    m = np.asarray(matrices, np.float64)
    products = np.empty((*m.shape[:-2], 4, 4))
    trace = np.trace(m, axis1=-2, axis2=-1)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        products[..., i, i] = 1 - trace + 2 * m[..., i, i]
        products[..., j, k] = products[..., k, j] = m[..., k, j] + m[..., j, k]
        products[..., i, 3] = products[..., 3, i] = m[..., k, j] - m[..., j, k]
    products[..., 3, 3] = 1 + trace
    squares = np.diagonal(products, axis1=-2, axis2=-1)
    best = squares.argmax(axis=-1)[..., None, None]
    rows = np.take_along_axis(products, best, axis=-2)[..., 0, :]
    return _array(normalise(np.where(rows[..., 3:] < 0, -rows, rows)))


def compose(
    translations: ArrayLike, rotations: ArrayLike, scales: ArrayLike
) -> Array:
    """Matrices (..., 4, 4) that scale, then rotate, then translate.

    ``translations`` and ``scales`` are (..., 3), ``rotations`` quaternions
    (..., 4); their leading axes are broadcast.
    """
    translations = np.asarray(translations, np.float64)
    scales = np.asarray(scales, np.float64)
    linear = quaternion_to_matrix(rotations) * scales[..., None, :]
    shape = np.broadcast_shapes(linear.shape[:-2], translations.shape[:-1])
    matrix = np.zeros((*shape, 4, 4))
    matrix[..., :3, :3] = linear
    matrix[..., :3, 3] = translations
    matrix[..., 3, 3] = 1
    return matrix


def decompose(matrices: ArrayLike) -> tuple[Array, Array, Array]:
    """Translations, unit quaternions and scales of affine (..., 4, 4).

    The inverse of :func:`compose` up to the choice of signs: a mirroring
    matrix gets a negative z scale, all other scales are positive or zero.
    Zero scale still gives a rotation. Shear is left out; where it matters
    use :func:`rotation_and_stretch`.
    """
    matrices = np.asarray(matrices, np.float64)
    rotation, stretch = rotation_and_stretch(matrices[..., :3, :3])
    scale = np.diagonal(stretch, axis1=-2, axis2=-1)
    return matrices[..., :3, 3].copy(), rotation, scale.copy()


def rotation_and_stretch(linear: ArrayLike) -> tuple[Array, Array]:
    """Split (..., 3, 3) into a rotation and an upper triangular stretch.

    Returns unit quaternions (..., 4) and stretches (..., 3, 3) so that
    ``quaternion_to_matrix(rotation) @ stretch`` is ``linear``: a QR
    factorisation by Gram and Schmidt, on unit columns so that scales of any
    size keep their precision. The diagonal of the stretch is the scale, the
    rest is shear. Columns of zero length are completed to a frame.
    """
    linear = np.asarray(linear, np.float64)
    columns = np.moveaxis(linear, -1, 0)
    x, y, z = (normalise(column) for column in columns)
    x = _or_across(x, y, z, 0)
    y = _or_across(y, z, x, 1)
    z_axis = normalise(_across(x, y, 2))
    z_axis = normalise(z_axis - x * (x * z_axis).sum(axis=-1, keepdims=True))
    matrix = np.stack([x, np.cross(z_axis, x), z_axis], axis=-1)
    stretch = np.triu(np.swapaxes(matrix, -1, -2) @ linear)
    return matrix_to_quaternion(matrix), _array(stretch)


def _or_across(vector: Array, first: Array, second: Array, axis: int) -> Array:
    """``vector``, or where it is zero a unit vector across the others."""
    missing = ~vector.any(axis=-1, keepdims=True)
    return np.where(missing, _across(first, second, axis), vector)


def _across(first: Array, second: Array, axis: int) -> Array:
    """first x second; if they are parallel some unit vector across them."""
    cross = np.cross(first, second)
    parallel = np.linalg.norm(cross, axis=-1, keepdims=True) < _PARALLEL
    known = np.where(first.any(axis=-1, keepdims=True), first, second)
    return np.where(parallel, _perpendicular(known, axis), normalise(cross))


def _perpendicular(unit: Array, axis: int) -> Array:
    """A unit vector across ``unit``, close to ``axis`` where that can be."""
    steep = np.abs(unit[..., axis, None]) > 0.9
    near = np.where(steep, _IDENTITY[(axis + 1) % 3], _IDENTITY[axis])
    return normalise(near - unit * (unit * near).sum(axis=-1, keepdims=True))


def look_rotation(forward: ArrayLike, up: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) that turn -Z towards ``forward``.

    +Y then points as far towards ``up`` as it can; both are (..., 3) of any
    length. Where ``up`` is zero or parallel to ``forward``, +X stays where
    it is if possible. ``forward`` must not be zero.
    """
    back = -normalise(forward)
    right = _cross(normalise(up), back)
    parallel = np.linalg.norm(right, axis=-1, keepdims=True) < _PARALLEL
    if parallel.any():
        right = np.where(parallel, _perpendicular(back, 0), right)
    right = normalise(right)
    return np.stack([right, _cross(back, right), back], axis=-1)


def _cross(first: Array, second: Array) -> Array:
    """Cross products (..., 3), a fifth of the time of NumPy's for one."""
    product: Array = (
        first[..., _AFTER] * second[..., _BEFORE]
        - first[..., _BEFORE] * second[..., _AFTER]
    )
    return product


def forward_directions(matrices: ArrayLike) -> Array:
    """Unit vectors (..., 3) along the -Z axes of affine (..., 4, 4).

    Where cameras and lights of glTF look; scale does not matter, not even
    one of zero.
    """
    linear = np.asarray(matrices, np.float64)[..., :3, :3]
    back = normalise(linear[..., 2])
    flat = ~back.any(axis=-1, keepdims=True)
    if flat.any():
        rotation = quaternion_to_matrix(rotation_and_stretch(linear)[0])
        back = np.where(flat, rotation[..., 2], back)
    return -back


def invert_affine(matrices: ArrayLike) -> Array:
    """Inverses of affine matrices (..., 4, 4).

    Raises numpy.linalg.LinAlgError where a matrix has no inverse.
    """
    matrices = np.asarray(matrices, np.float64)
    inverse = np.zeros(matrices.shape)
    inverse[..., :3, :3] = np.linalg.inv(matrices[..., :3, :3])
    inverse[..., :3, 3:] = -inverse[..., :3, :3] @ matrices[..., :3, 3:]
    inverse[..., 3, 3] = 1
    return inverse


def cofactor_matrix(linear: ArrayLike) -> Array:
    """Cofactors (..., 3, 3): determinant times the inverse transpose."""
    x, y, z = np.moveaxis(np.asarray(linear, np.float64), -1, 0)
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)


def is_mirrored(matrices: ArrayLike) -> NDArray[np.bool_]:
    """Whether matrices (..., 4, 4) or (..., 3, 3) turn right hands to left.

    glTF 2.0, 3.7.4: such a node's triangles have clockwise front faces.
    """
    x, y, z = np.moveaxis(np.asarray(matrices)[..., :3, :3], -1, 0)
    return np.asarray((np.cross(x, y) * z).sum(axis=-1) < 0)


def normal_matrix(matrices: ArrayLike) -> Array:
    """Matrices (..., 3, 3) that turn normals along with (..., 4, 4).

    Parallel to the inverse transpose, but made of cofactors, so that flat
    (zero) scales have one too; the largest entry is 1, so that tiny scales
    survive float32. Normals must be normalised after it.
    """
    linear = np.asarray(matrices, np.float64)[..., :3, :3]
    size = np.abs(linear).max(axis=(-2, -1), keepdims=True)
    cofactors = cofactor_matrix(linear / np.where(size > 0, size, 1))
    size = np.abs(cofactors).max(axis=(-2, -1), keepdims=True)
    sign = np.where(is_mirrored(linear), -1.0, 1.0)[..., None, None]
    return _array(sign * cofactors / np.where(size > 0, size, 1))


def column_major(matrices: ArrayLike) -> NDArray[np.float32]:
    """Matrices (..., R, C) as float32 in the order in which GLSL reads them.

    The result has shape (..., C, R); its bytes are those of a mat4 in a
    uniform or a std140 block.
    """
    swapped = np.swapaxes(np.asarray(matrices), -1, -2)
    return np.ascontiguousarray(swapped, np.float32)


def transform_bounds(matrices: ArrayLike, bounds: ArrayLike) -> Array:
    """Axis-aligned boxes (..., 2, 3) around transformed boxes (..., 2, 3).

    ``bounds[..., 0, :]`` is the least corner, ``bounds[..., 1, :]`` the
    greatest. The centre goes through the affine (..., 4, 4) matrix, the half
    extent through its absolute values (Arvo 1990, "Transforming Axis-Aligned
    Bounding Boxes"), so that mirrored and zero scales need no special case.
    """
    matrices = np.asarray(matrices, np.float64)
    bounds = np.asarray(bounds, np.float64)
    linear = matrices[..., :3, :3]
    centre = 0.5 * (bounds[..., 0, :] + bounds[..., 1, :])
    extent = 0.5 * (bounds[..., 1, :] - bounds[..., 0, :])
    centre = (linear @ centre[..., None])[..., 0] + matrices[..., :3, 3]
    extent = (np.abs(linear) @ extent[..., None])[..., 0]
    return np.stack([centre - extent, centre + extent], axis=-2)


def union_bounds(bounds: ArrayLike) -> Array:
    """The box (2, 3) around boxes (N, 2, 3), N at least 1."""
    bounds = np.asarray(bounds, np.float64)
    return np.stack([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])


def _array(value: Any) -> Array:
    """NumPy's own annotations lose the element type of some results."""
    return np.asarray(value, np.float64)
