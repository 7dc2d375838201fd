"""A camera around a point: what each gesture keeps, and what it changes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.ui.orbit_controls import OrbitControls

LENSES = (Perspective(math.radians(45)), Orthographic(1.5, 1.0, 0.0, 100.0))

angles = st.floats(-3.0, 3.0)
motions = st.floats(-0.5, 0.5)


def controls_of(yaw: float, pitch: float) -> OrbitControls:
    controls = OrbitControls()
    controls.yaw, controls.pitch = yaw, max(min(pitch, 1.5), -1.5)
    controls.target = np.array([1.0, -2.0, 0.5])
    controls.distance = 3.0
    return controls


def seen(camera: Camera, point: np.ndarray) -> np.ndarray:
    """Where a point is, in halves of the picture's height; y up."""
    clip = (
        camera.projection_matrix(1.0, reversed_z=True)
        @ camera.view_matrix
        @ np.append(point, 1.0)
    )
    scale = camera.projection_matrix(1.0, reversed_z=True)[1, 1]
    width = scale / camera.projection_matrix(1.0, reversed_z=True)[0, 0]
    return clip[:2] / clip[3] * (width, 1.0)


@given(angles, angles, motions, motions)
def test_an_orbit_keeps_the_target_in_the_middle(
    yaw: float, pitch: float, across: float, down: float
) -> None:
    controls = controls_of(yaw, pitch)
    controls.orbit(across, down)
    camera = Camera()
    controls.apply(camera)
    assert math.dist(camera.position, controls.target) == pytest.approx(3.0)
    np.testing.assert_allclose(seen(camera, controls.target), 0, atol=1e-9)
    # Never upside down.
    assert camera.transform.world_matrix[1, 1] > 0


@given(angles, angles, motions, motions, st.sampled_from(LENSES))
def test_a_pan_takes_what_is_under_the_pointer_along(
    yaw: float,
    pitch: float,
    across: float,
    down: float,
    lens: Perspective | Orthographic,
) -> None:
    controls = controls_of(yaw, pitch)
    camera = Camera(lens)
    held = controls.target.copy()
    controls.pan(across, down, camera)
    controls.apply(camera)
    np.testing.assert_allclose(
        seen(camera, held), (2 * across, -2 * down), atol=1e-9
    )


@given(
    angles, angles, motions, motions, st.floats(-3, 3), st.sampled_from(LENSES)
)
def test_a_zoom_keeps_what_is_under_the_pointer(
    yaw: float,
    pitch: float,
    x: float,
    y: float,
    clicks: float,
    lens: Perspective | Orthographic,
) -> None:
    controls = controls_of(yaw, pitch)
    camera = Camera(lens)
    controls.apply(camera)
    half = (
        3.0 * math.tan(math.radians(22.5))
        if isinstance(lens, Perspective)
        else 1.0
    )
    world = camera.transform.world_matrix
    point = controls.target + half * (x * world[:3, 0] + y * world[:3, 1])
    np.testing.assert_allclose(seen(camera, point), (x, y), atol=1e-9)
    controls.zoom(clicks, camera, (x, y))
    controls.apply(camera)
    np.testing.assert_allclose(seen(camera, point), (x, y), atol=1e-9)
    assert (controls.distance < 3.0) == (clicks > 0) or abs(clicks) < 1e-9


def test_a_flight_goes_where_the_camera_looks() -> None:
    controls = controls_of(0.5, 0.2)
    camera = Camera()
    controls.apply(camera)
    before, back = camera.position, camera.transform.world_matrix[:3, 2]
    controls.fly(0.0, 0.0, 0.25)
    controls.apply(camera)
    np.testing.assert_allclose(camera.position, before - 0.75 * back)
    controls.fly(0.0, 0.0, 0.0, turn=(0.1, 0.05))
    controls.apply(camera)
    np.testing.assert_allclose(camera.position, before - 0.75 * back)


@given(angles, st.floats(-1.4, 1.4))
def test_it_goes_on_from_any_upright_camera(yaw: float, pitch: float) -> None:
    placed = Camera()
    controls_of(yaw, pitch).apply(placed)
    controls = OrbitControls()
    controls.look_from(placed, 3.0)
    again = Camera()
    controls.apply(again)
    np.testing.assert_allclose(
        again.transform.world_matrix, placed.transform.world_matrix, atol=1e-9
    )


def test_a_pivot_does_not_move_the_camera() -> None:
    controls = controls_of(0.5, 0.2)
    before = controls.position
    controls.set_pivot((3.0, 1.0, -1.0))
    np.testing.assert_allclose(controls.position, before)
    np.testing.assert_allclose(controls.target, (3.0, 1.0, -1.0))


def test_a_box_is_framed_from_the_same_side() -> None:
    controls = controls_of(0.5, 0.2)
    camera = Camera()
    box = np.array([[-1.0, 0.0, 2.0], [3.0, 1.0, 4.0]])
    controls.frame(box, camera, 1.5)
    controls.apply(camera)
    assert (controls.yaw, controls.pitch) == (0.5, 0.2)
    corners = np.array(
        [[x, y, z] for x in box[:, 0] for y in box[:, 1] for z in box[:, 2]]
    )
    places = np.array([seen(camera, corner) for corner in corners])
    assert (np.abs(places) <= (1.5, 1.0)).all()


def test_another_lens_shows_the_target_as_large() -> None:
    camera, controls = Camera(), OrbitControls()
    controls.distance = 3.0
    controls.apply(camera)
    position = controls.position
    controls.change_lens(camera)
    lens = camera.projection
    assert isinstance(lens, Orthographic)
    assert lens.ymag == pytest.approx(3.0 * math.tan(math.radians(22.5)))
    controls.change_lens(camera)
    assert isinstance(camera.projection, Perspective)
    np.testing.assert_allclose(controls.position, position)


@pytest.mark.parametrize("parallel", [False, True])
def test_a_look_is_what_the_camera_sees(parallel: bool) -> None:
    camera, controls = Camera(Perspective(0.6)), OrbitControls()
    controls.target = np.array([0.5, -1.25, 3.0])
    controls.orbit(0.3, -0.2)
    controls.apply(camera)
    if parallel:
        controls.change_lens(camera)
    again = controls.look(camera).camera()
    np.testing.assert_allclose(
        again.view_matrix, camera.view_matrix, atol=1e-12
    )
    np.testing.assert_allclose(
        again.projection_matrix(1.5), camera.projection_matrix(1.5)
    )
