"""Culling never leaves out what can be seen, whatever the camera."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.maths import transform_bounds
from moka.core.projection import look_at
from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.scene.culling import (
    boxes_below,
    boxes_in_frustum,
    pack_boxes,
    view_depths,
)
from moka.scene.transform import Transform

PROJECTIONS = [
    Perspective(0.9, near=0.1, far=20),
    Perspective(2.5, near=1e-3, far=1e6),
    Perspective(0.2, near=0.5),
    Orthographic(3, 2, 0, 15),
]


def random_camera(random: np.random.Generator, projection: object) -> Camera:
    transform = Transform(random.uniform(-5, 5, 3), random.normal(size=4))
    return Camera(projection, transform)  # type: ignore[arg-type]


def seen(camera: Camera, aspect: float, points: np.ndarray) -> np.ndarray:
    """Which points (..., 3) lie in OpenGL's clip volume."""
    matrix = camera.projection_matrix(aspect) @ camera.view_matrix
    ones = np.ones((*points.shape[:-1], 1))
    clip = np.concatenate([points, ones], axis=-1) @ matrix.T
    return np.asarray((np.abs(clip[..., :3]) <= clip[..., 3:]).all(axis=-1))


@pytest.mark.parametrize("projection", PROJECTIONS)
@given(
    seed=st.integers(0, 2**32 - 1),
    aspect=st.sampled_from([0.4, 1.0, 2.4]),
    scale=st.sampled_from([(1, 1, 1), (-1, 2, 1), (0, 1, 3), (0, 0, 0)]),
)
def test_a_box_with_a_visible_point_is_kept(
    projection: object, seed: int, aspect: float, scale: tuple[int, ...]
) -> None:
    """Boxes of any size, mirrored and flat ones, around the camera too."""
    random = np.random.default_rng(seed)
    camera = random_camera(random, projection)
    world = np.tile(np.eye(4), (50, 1, 1))
    world[:, :3, :3] = random.normal(size=(50, 3, 3)) * scale
    world[:, :3, 3] = random.uniform(-15, 15, (50, 3))
    corners = random.normal(size=(50, 2, 3))
    corners *= 10.0 ** random.uniform(-2, 1, (50, 1, 1))
    local = np.sort(corners, axis=1)
    within = random.uniform(size=(50, 100, 3))
    points = local[:, :1] + within * (local[:, 1:] - local[:, :1])
    points = points @ np.swapaxes(world[:, :3, :3], 1, 2)
    points += world[:, None, :3, 3]
    kept = boxes_in_frustum(
        camera.frustum_planes(aspect),
        pack_boxes(transform_bounds(world, local)),
    )
    assert kept[seen(camera, aspect, points).any(axis=1)].all()


def cube(x: float, y: float, z: float, size: float = 1) -> list[list[float]]:
    return [[x - size, y - size, z - size], [x + size, y + size, z + size]]


@pytest.mark.parametrize(
    ("box", "kept"),
    [
        (cube(0, 0, -10), True),
        (cube(0, 0, 10), False),  # Behind.
        (cube(0, 0, 0), True),  # The camera is inside.
        (cube(0, 0, 0, 1e6), True),
        (cube(11.5, 0, -10), True),  # Straddles the right edge.
        (cube(13, 0, -10), False),
        (cube(-13, 0, -10), False),
        (cube(0, 13, -10), False),
        (cube(0, 0, -102), False),  # Beyond the far plane.
        (cube(0, 0, -100.5), True),
        (cube(0, 0, 0.05, 0.04), False),
        ([[0, 0, -5], [0, 0, -5]], True),  # A point.
        ([[0, 0, math.nan], [0, 0, math.nan]], True),
        ([[-math.inf] * 3, [math.inf] * 3], True),
    ],
)
def test_boxes_around_a_right_angle(box: list[list[float]], kept: bool) -> None:
    camera = Camera(Perspective(math.pi / 2, near=0.1, far=100))
    result = boxes_in_frustum(camera.frustum_planes(1.0), pack_boxes([box]))
    assert result.tolist() == [kept]


def test_infinite_far_keeps_the_horizon() -> None:
    camera = Camera(Perspective(1.0, near=0.01))
    planes = camera.frustum_planes(1.0)
    boxes = [cube(0, 0, -1e12), cube(0, 0, 1e12)]
    assert boxes_in_frustum(planes, pack_boxes(boxes)).tolist() == [True, False]


def test_no_boxes_are_no_problem() -> None:
    planes = Camera().frustum_planes(1.0)
    assert boxes_in_frustum(planes, pack_boxes(np.zeros((0, 2, 3)))).shape == (
        0,
    )


def test_depth_is_along_the_axis_and_not_the_distance() -> None:
    view = look_at((0, 0, 5), (0, 0, 0))
    boxes = [cube(0, 0, 0), cube(30, 40, -5), cube(0, 0, 9)]
    assert_allclose(view_depths(view, pack_boxes(boxes)), [5, 10, 0])


def test_depth_of_what_is_not_finite_is_zero() -> None:
    boxes = [[[-math.inf] * 3, [math.inf] * 3], [[math.nan] * 3] * 2]
    assert view_depths(np.eye(4), pack_boxes(boxes)).tolist() == [0, 0]


def test_depth_fits_a_float32() -> None:
    depth = view_depths(np.eye(4), pack_boxes([cube(0, 0, -1e200)]))
    assert np.isfinite(depth.astype(np.float32)).all()


@pytest.mark.parametrize(
    "projection",
    [
        Perspective(1.0, near=0.1),
        Perspective(2.4, near=0.1),
        Orthographic(5, 5, 0, 15),
    ],
)
@given(seed=st.integers(0, 2**32), part=st.floats(1e-3, 0.5))
def test_what_is_below_a_size_nowhere_covers_it(
    projection: Perspective | Orthographic, seed: int, part: float
) -> None:
    """Corners of boxes as they are projected; of the picture 2 x 1."""
    random = np.random.default_rng(seed)
    camera = random_camera(random, projection)
    middle = random.uniform(-15, 15, (200, 1, 3))
    half = 10.0 ** random.uniform(-3, 0, (200, 1, 3))
    bounds = middle + half * np.array([[[-1.0]], [[1.0]]]).reshape(1, 2, 1)
    matrix = camera.projection_matrix(2.0, reversed_z=True)
    boxes = pack_boxes(bounds)
    below = boxes_below(part, camera.view_matrix, matrix, boxes)
    below &= boxes_in_frustum(camera.frustum_planes(2.0), boxes)
    corners = np.stack(
        [
            bounds[:, [x, y, z], [0, 1, 2]]
            for x, y, z in itertools.product((0, 1), repeat=3)
        ],
        axis=1,
    )
    corners = np.concatenate([corners, np.ones((200, 8, 1))], axis=2)
    clip = corners @ (matrix @ camera.view_matrix).T
    shown = below & (clip[..., 3] > 0).all(axis=1)
    place = clip[shown][..., :2] / clip[shown][..., 3:]
    size = np.ptp(place, axis=1) / 2 * (2.0, 1.0)
    assert (size <= part * (1 + 1e-9)).all()


def test_a_size_is_close_to_what_is_seen() -> None:
    """A sphere's box at 10 m in the middle, in a view 2 m high at 1 m."""
    camera = Camera(Perspective(math.pi / 2, near=0.1))
    boxes = pack_boxes([cube(0, 0, -10, 1 / math.sqrt(3))])
    matrix = camera.projection_matrix(1.0, reversed_z=True)
    for part, expected in ((0.1, False), (0.2, True)):
        below = boxes_below(part, camera.view_matrix, matrix, boxes)
        assert below.tolist() == [expected]


def test_what_has_no_size_or_no_end_is_not_small() -> None:
    camera = Camera()
    matrix = camera.projection_matrix(1.0, reversed_z=True)
    boxes = [[[-math.inf] * 3, [math.inf] * 3], [[math.nan] * 3] * 2]
    below = boxes_below(1.0, camera.view_matrix, matrix, pack_boxes(boxes))
    assert below.tolist() == [False, False]
