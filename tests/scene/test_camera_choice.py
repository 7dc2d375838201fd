"""What --camera means and which camera it finds."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from moka.core.errors import OptionError
from moka.model.cameras import (
    CameraDescription,
    Orthographic,
    Perspective,
)
from moka.scene.camera import Camera
from moka.scene.camera_choice import (
    CameraChoice,
    Look,
    Orbit,
    choose_camera,
    look_text,
    parse_camera,
)
from moka.scene.scene import Scene
from tests.scene.models import make_model


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("front", "front"),
        ("Camera 01", "Camera 01"),
        ("0", 0),
        ("12", 12),
        ("1.5", "1.5"),
        ("9" * 5000, "9" * 5000),
        ("orbital", "orbital"),
        ("orbit:0,0", Orbit()),
        ("orbit:180,-90", Orbit(math.pi, -math.pi / 2)),
        ("orbit: 90 , 45 , 2.5", Orbit(math.pi / 2, math.pi / 4, 2.5)),
        ("orbit:-720,1e1", Orbit(-4 * math.pi, math.radians(10))),
        ("look:1,2,3,-4,5,6e1", Look((1, 2, 3), (-4, 5, 60))),
        ("look: 1,2,3, 0,0,0, 90", Look((1, 2, 3), (0, 0, 0), math.pi / 2)),
        ("look:1,2,3,0,0,0,2.5m", Look((1, 2, 3), (0, 0, 0), height=2.5)),
    ],
)
def test_choices(text: str, choice: CameraChoice) -> None:
    assert parse_camera(text) == choice


@pytest.mark.parametrize(
    "text",
    [
        "",
        "-1",
        "orbit:",
        "orbit:5",
        "orbit:1,2,3,4",
        "orbit:a,b",
        "orbit:1,,2",
        "orbit:nan,0",
        "orbit:0,inf",
        "orbit:0,91",
        "orbit:0,0,0",
        "orbit:0,0,-3",
        "look:",
        "look:1,2,3",
        "look:1,2,3,4,5",
        "look:1,2,3,4,5,6,7,8",
        "look:1,2,3,4,5,6m",
        "look:1,2,3,4,5,nan",
        "look:1,2,3,4,5,m",
        "look:1,2,3,1,2,3",
        "look:1,2,3,4,5,6,0",
        "look:1,2,3,4,5,6,180",
        "look:1,2,3,4,5,6,-2m",
    ],
)
def test_nonsense_is_one_line(text: str) -> None:
    with pytest.raises(OptionError, match="camera: ") as caught:
        parse_camera(text)
    assert "\n" not in str(caught.value)


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    lens = Perspective(0.7)
    scene.add(
        make_model(
            [1],
            [0, -1, -1],
            [-1, -1, -1],
            cameras={
                1: CameraDescription(lens, "front"),
                2: CameraDescription(lens, "back"),
            },
        )
    )
    return scene


def test_cameras_of_files_by_name_and_index(scene: Scene) -> None:
    front, back = scene.cameras
    assert choose_camera(scene, None, 1.0) is front
    assert choose_camera(scene, "back", 1.0) is back
    assert choose_camera(scene, 1, 1.0) is back


@pytest.mark.parametrize("choice", ["side", 2, -1])
def test_a_camera_that_is_not_there_lists_the_others(
    scene: Scene, choice: CameraChoice
) -> None:
    with pytest.raises(OptionError, match="0 'front', 1 'back'"):
        choose_camera(scene, choice, 1.0)


def test_without_cameras_the_scene_is_framed_from_the_front() -> None:
    scene = Scene()
    scene.add(make_model([1], [0], [-1]))
    chosen = choose_camera(scene, None, 2.0)
    framed = Camera()
    framed.frame(scene.bounds(), 2.0)
    assert_allclose(chosen.view_matrix, framed.view_matrix)
    with pytest.raises(OptionError, match="none, try orbit"):
        choose_camera(scene, 0, 2.0)


def test_an_orbit_goes_before_the_cameras_of_the_file(scene: Scene) -> None:
    camera = choose_camera(scene, Orbit(0.0, math.pi / 2, 3.0), 1.0)
    bounds = scene.bounds()
    assert bounds is not None
    centre = np.mean(bounds, axis=0)
    assert_allclose(camera.position, np.add(centre, (0, 3, 0)))


@pytest.mark.parametrize(
    "look",
    [
        Look((1.25, -2, 3e-3), (0.1, 7, 1 / 3)),
        Look((0, 0, 5), (0, 0, 0), math.radians(70)),
        Look((0, 9, 0), (0, 0, 0), height=2.5),
    ],
)
def test_a_look_is_the_camera_of_its_text(scene: Scene, look: Look) -> None:
    read = parse_camera(look_text(look))
    assert isinstance(read, Look)
    assert_allclose([*read.eye, *read.target], [*look.eye, *look.target])
    camera = choose_camera(scene, read, 1.5)
    assert_allclose(camera.position, look.eye)
    seen = camera.view_matrix @ [*look.target, 1.0]
    assert_allclose(seen[:2], 0.0, atol=1e-12)
    assert_allclose(-seen[2], math.dist(look.eye, look.target))
    if look.height is not None:
        assert isinstance(camera.projection, Orthographic)
        assert camera.projection.ymag == 1.25
    else:
        assert isinstance(camera.projection, Perspective)
        expected = look.yfov or math.radians(45)
        assert camera.projection.yfov == pytest.approx(expected)
