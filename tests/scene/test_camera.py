"""Cameras: what they project, and that framing shows all of a box."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pyglm import glm

from moka.core.errors import OptionError
from moka.core.projection import orthographic, perspective
from moka.model.cameras import CameraDescription, Orthographic, Perspective
from moka.scene.camera import Camera
from moka.scene.transform import Transform

PROJECTIONS = [
    Perspective(math.radians(45)),
    Perspective(2.8, near=5, far=6),
    Orthographic(1, 1, 0, 1),
]
ASPECTS = [0.25, 1.0, 16 / 9, 5.0]


def corners(bounds: np.ndarray) -> np.ndarray:
    return np.array(list(itertools.product(*bounds.T)))


def project(camera: Camera, aspect: float, points: np.ndarray) -> np.ndarray:
    """Normalised device coordinates (N, 3) of points (N, 3)."""
    matrix = camera.projection_matrix(aspect) @ camera.view_matrix
    clip = np.c_[points, np.ones(len(points))] @ matrix.T
    return np.asarray(clip[:, :3] / clip[:, 3:])


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("aspect", ASPECTS)
@given(
    yaw=st.floats(-4, 4),
    pitch=st.floats(-math.pi / 2, math.pi / 2),
    exponent=st.integers(-3, 6),
    seed=st.integers(0, 2**32 - 1),
)
def test_all_corners_of_a_framed_box_are_in_the_picture(
    projection: Perspective | Orthographic,
    aspect: float,
    yaw: float,
    pitch: float,
    exponent: int,
    seed: int,
) -> None:
    random = np.random.default_rng(seed)
    size = 10.0**exponent
    bounds = np.sort(size * random.normal(size=(2, 3)), axis=0)
    bounds += size * random.normal(size=3)
    camera = Camera(projection)
    camera.frame(bounds, aspect, yaw, pitch)
    assert (np.abs(project(camera, aspect, corners(bounds))) < 1 + 1e-9).all()


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("aspect", ASPECTS)
def test_the_framed_sphere_touches_the_edge(
    projection: Perspective | Orthographic, aspect: float
) -> None:
    bounds = np.array([[1.0, 2, 3], [5, 4, 9]])
    camera = Camera(projection)
    camera.frame(bounds, aspect, 0.7, -0.3)
    centre, radius = bounds.mean(axis=0), math.dist(*bounds) / 2
    distances = camera.frustum_planes(aspect) @ [*centre, 1]
    assert_allclose(distances[:4].min(), radius)


def test_yaw_goes_towards_x_and_pitch_upwards() -> None:
    camera = Camera()
    bounds = [[9, 9, 9], [11, 11, 11]]
    camera.frame(bounds, 1.0, 0.0, 0.0, 5)
    assert_allclose(camera.position, [10, 10, 15])
    camera.frame(bounds, 1.0, math.pi / 2, 0.0, 5)
    assert_allclose(camera.position, [15, 10, 10])
    camera.frame(bounds, 1.0, 0.0, math.pi / 2, 5)
    assert_allclose(camera.position, [10, 15, 10])
    assert_allclose(camera.view_matrix[0, :3], [1, 0, 0], atol=1e-15)


def test_what_is_framed_up_close_is_not_clipped() -> None:
    camera = Camera()
    camera.frame([[-20, -20, -20], [20, 20, 20]], 1.0, distance=0.1)
    target = project(camera, 1.0, np.zeros((1, 3)))
    assert (np.abs(target) < 1).all()


def test_framing_below_a_parent_places_the_camera_in_the_world() -> None:
    camera = Camera()
    camera.transform.set_parent(Transform((5, 0, 0), (0, 1, 0, 1), 2))
    camera.frame([[-1, -1, -1], [1, 1, 1]], 1.0, distance=7)
    assert_allclose(camera.position, [0, 0, 7], atol=1e-12)


def test_nothing_to_frame_is_the_unit_sphere() -> None:
    empty, sphere = Camera(), Camera()
    empty.frame(None, 1.0)
    side = 2 / math.sqrt(3)
    sphere.frame(np.array([[-side / 2] * 3, [side / 2] * 3]), 1.0)
    assert_allclose(empty.view_matrix, sphere.view_matrix)


def test_a_point_can_be_framed() -> None:
    camera = Camera()
    camera.frame([[1e6, 0, 0], [1e6, 0, 0]], 1.0)
    assert_allclose(project(camera, 1.0, np.array([[1e6, 0, 0]]))[0, :2], 0)


@pytest.mark.parametrize(
    ("bounds", "yaw", "distance", "message"),
    [
        ([[0, 0, 0], [1, 1, math.inf]], 0, None, "bounds"),
        ([0, 1], 0, None, "bounds"),
        ([[0, 0, 0], [1, 1, 1]], math.nan, None, "yaw"),
        ([[0, 0, 0], [1, 1, 1]], 0, 0, "distance"),
        ([[0, 0, 0], [1, 1, 1]], 0, math.nan, "distance"),
    ],
)
def test_framing_nonsense(
    bounds: object, yaw: float, distance: float | None, message: str
) -> None:
    with pytest.raises(OptionError, match=message):
        Camera().frame(bounds, 1.0, yaw, 0.0, distance)  # type: ignore[arg-type]


def test_view_is_that_of_glm() -> None:
    camera = Camera()
    camera.transform.position = (3, 4, 5)
    camera.transform.look_at((-1, 0, 2))
    expected = glm.lookAt(
        glm.dvec3(3, 4, 5), glm.dvec3(-1, 0, 2), glm.dvec3(0, 1, 0)
    )
    assert_allclose(camera.view_matrix, np.asarray(expected), atol=1e-12)
    assert_allclose(camera.position, [3, 4, 5])


@pytest.mark.parametrize("scale", [(2, 2, 2), (1, 3, 0.5), (0, 0, 0)])
def test_scale_above_a_camera_is_ignored(scale: tuple[float, ...]) -> None:
    """glTF 2.0, 3.10.2: the view matrix has none."""
    camera = Camera(transform=Transform((1, 2, 3), (0, 1, 0, 1), scale))
    plain = Camera(transform=Transform((1, 2, 3), (0, 1, 0, 1)))
    if any(scale):
        assert_allclose(camera.view_matrix, plain.view_matrix, atol=1e-12)
    linear = camera.view_matrix[:3, :3]
    assert_allclose(linear @ linear.T, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("reversed_z", [False, True])
def test_the_vertical_angle_of_a_file_wins_over_its_aspect(
    reversed_z: bool,
) -> None:
    description = CameraDescription(Perspective(0.8, 3.0, 0.2, 50), "front")
    camera = Camera.from_description(description)
    assert camera.name == "front"
    assert_allclose(
        camera.projection_matrix(1.5, reversed_z=reversed_z),
        perspective(0.8, 1.5, 0.2, 50, reversed_z=reversed_z),
    )


@pytest.mark.parametrize("reversed_z", [False, True])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_height_of_a_parallel_camera_wins_over_its_width(
    sign: int, reversed_z: bool
) -> None:
    camera = Camera(Orthographic(sign * 7, sign * 2, 0, 50))
    assert_allclose(
        camera.projection_matrix(1.5, reversed_z=reversed_z),
        orthographic(3, 2, 0, 50, reversed_z=reversed_z),
    )


@pytest.mark.parametrize(
    "projection",
    [
        Perspective(0),
        Perspective(math.pi),
        Perspective(math.nan),
        Perspective(1, near=0),
        Perspective(1, near=2, far=1),
        Perspective(1, near=math.inf),
        Orthographic(1, 0, 0, 1),
        Orthographic(1, 1, 1, 1),
        Orthographic(1, 1, 0, math.inf),
    ],
)
def test_projections_that_show_nothing(
    projection: Perspective | Orthographic,
) -> None:
    with pytest.raises(OptionError, match="camera: "):
        Camera(projection)


def test_reversed_depth_tells_neighbours_apart_from_1e_3_to_1e6() -> None:
    """In float32, a part in ten thousand at every distance."""
    camera = Camera(Perspective(1.0, near=1e-3))
    matrix = camera.projection_matrix(1.0, reversed_z=True)
    distance = np.geomspace(1.1e-3, 1e6, 200)
    depth = np.float32(matrix[2, 3] / distance)
    nearer = np.float32(matrix[2, 3] / (distance * (1 - 1e-4)))
    assert (nearer > depth).all()
