"""Points behind pixels, and boxes in front of them, against projection."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.ui.picking import point_at
from moka.ui.selection import box_edges

LENSES = (Perspective(math.radians(50)), Orthographic(3.0, 2.0, 0.0, 100.0))
SIZE = (300, 200)


def camera_of(lens: Perspective | Orthographic) -> Camera:
    camera = Camera(lens)
    camera.transform.position = (1.0, 2.0, 3.0)
    camera.transform.look_at((0.2, -0.3, -1.0))
    return camera


def project(camera: Camera, point: np.ndarray) -> np.ndarray:
    """Window coordinates, origin at the upper left."""
    width, height = SIZE
    matrix = camera.projection_matrix(width / height, reversed_z=True)
    clip = matrix @ camera.view_matrix @ np.append(point, 1.0)
    return np.array(
        [
            (clip[0] / clip[3] + 1) / 2 * width,
            (1 - clip[1] / clip[3]) / 2 * height,
        ]
    )


@given(
    st.integers(0, SIZE[0] - 1),
    st.integers(0, SIZE[1] - 1),
    st.floats(0.1, 1000.0),
    st.sampled_from(LENSES),
)
def test_a_point_projects_to_its_pixel_at_its_depth(
    x: int, y: int, depth: float, lens: Perspective | Orthographic
) -> None:
    camera = camera_of(lens)
    point = point_at(camera, (x, y), SIZE, depth)
    np.testing.assert_allclose(
        project(camera, point), (x + 0.5, y + 0.5), atol=1e-6
    )
    seen = camera.view_matrix @ np.append(point, 1.0)
    assert -seen[2] == pytest.approx(depth, rel=1e-9)


@pytest.mark.parametrize("lens", LENSES)
def test_edges_of_a_box_in_view_join_its_corners(
    lens: Perspective | Orthographic,
) -> None:
    camera = camera_of(lens)
    box = np.array([[-0.5, -0.25, -0.5], [0.5, 0.25, 0.0]])
    edges = box_edges(box, camera, SIZE)
    assert edges.shape == (12, 2, 2)
    corners = {
        tuple(np.round(project(camera, np.array([x, y, z])), 6))
        for x in box[:, 0]
        for y in box[:, 1]
        for z in box[:, 2]
    }
    ends = {tuple(np.round(end, 6)) for end in edges.reshape(-1, 2)}
    assert ends == corners


def test_edges_behind_the_camera_are_cut_off() -> None:
    camera = camera_of(LENSES[0])
    behind = np.array([[1.0, 2.5, 5.0], [2.0, 3.0, 6.0]])
    assert len(box_edges(behind, camera, SIZE)) == 0
    around = np.array([[-9.0, -9.0, -9.0], [9.0, 9.0, 9.0]])
    edges = box_edges(around, camera, SIZE)
    assert 0 < len(edges) < 12
    assert np.isfinite(edges).all()
