"""Cameras and punctual lights, and where nodes place them."""

import math
from typing import Any

import pytest

from moka.core.errors import ModelError
from moka.model import (
    CameraDescription,
    LightKind,
    Model,
    Orthographic,
    Perspective,
    PunctualLight,
    load_model,
)
from tests.model.files import glb, triangle


def with_cameras(*cameras: dict[str, Any]) -> Model:
    return load_model(glb(triangle(cameras=list(cameras))))


def with_lights(*lights: dict[str, Any], **changes: Any) -> Model:
    extensions = {"KHR_lights_punctual": {"lights": list(lights)}}
    return load_model(glb(triangle(extensions=extensions, **changes)))


def test_perspective_cameras() -> None:
    model = with_cameras(
        {
            "type": "perspective",
            "perspective": {
                "yfov": 0.5,
                "aspectRatio": 1.5,
                "znear": 0.1,
                "zfar": 20,
            },
            "name": "near",
        },
        {"type": "perspective", "perspective": {"yfov": 1, "znear": 2}},
    )
    assert model.cameras == [
        CameraDescription(Perspective(0.5, 1.5, 0.1, 20.0), "near"),
        CameraDescription(Perspective(1.0, None, 2.0, math.inf)),
    ]


def test_orthographic_cameras() -> None:
    view = {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 5}
    model = with_cameras({"type": "orthographic", "orthographic": view})
    assert model.cameras == [CameraDescription(Orthographic(2, 1, 0, 5))]


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        ({"type": "perspective"}, "perspective: is missing"),
        (
            {
                "type": "orthographic",
                "perspective": {"yfov": 1, "znear": 1},
            },
            "orthographic: is missing",
        ),
        ({"type": "fisheye"}, "type: invalid enum value 'fisheye'"),
        (
            {"type": "perspective", "perspective": {"yfov": 0, "znear": 1}},
            "perspective.yfov: must lie between 0 and pi",
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 4, "znear": 1}},
            "perspective.yfov: must lie between 0 and pi",
        ),
        (
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 0}},
            "perspective.znear: must be greater than 0",
        ),
        (
            {
                "type": "perspective",
                "perspective": {"yfov": 1, "znear": 2, "zfar": 2},
            },
            "perspective.znear: must be greater than 0 and less than zfar",
        ),
        (
            {
                "type": "perspective",
                "perspective": {"yfov": 1, "znear": 2, "aspectRatio": 0},
            },
            "perspective.aspectRatio: must be greater than 0",
        ),
        (
            {
                "type": "orthographic",
                "orthographic": {"xmag": 1, "ymag": 0, "znear": 0, "zfar": 1},
            },
            "orthographic.ymag: must not be 0",
        ),
        (
            {
                "type": "orthographic",
                "orthographic": {"xmag": 1, "ymag": 1, "znear": 1, "zfar": 1},
            },
            "orthographic.znear: must be at least 0 and less than zfar",
        ),
    ],
)
def test_names_what_is_wrong_with_a_camera(
    camera: dict[str, Any], message: str
) -> None:
    with pytest.raises(ModelError) as caught:
        with_cameras(camera)
    assert str(caught.value).startswith(f"<bytes>: cameras[0].{message}")


def test_lights() -> None:
    model = with_lights(
        {"type": "directional"},
        {"type": "point", "color": [1, 0.5, 0], "intensity": 60, "range": 9},
        {
            "type": "spot",
            "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2},
            "name": "lamp",
        },
        {"type": "spot", "spot": {}},
    )
    assert model.lights == [
        PunctualLight(LightKind.DIRECTIONAL),
        PunctualLight(LightKind.POINT, (1.0, 0.5, 0.0), 60.0, 9.0),
        PunctualLight(
            LightKind.SPOT,
            inner_cone_angle=0.1,
            outer_cone_angle=0.2,
            name="lamp",
        ),
        PunctualLight(LightKind.SPOT, outer_cone_angle=math.pi / 4),
    ]
    assert math.isinf(model.lights[0].range)


def test_a_cone_of_pi_that_float32_rounded_up_is_cut() -> None:
    model = with_lights({"type": "spot", "spot": {"outerConeAngle": 1.5707964}})
    assert model.lights[0].outer_cone_angle == math.pi / 2


@pytest.mark.parametrize(
    ("light", "message"),
    [
        ({"type": "area"}, ".type: invalid enum value 'area'"),
        ({}, ": object missing required field 'type'"),
        ({"type": "point", "intensity": -1}, ": is negative"),
        ({"type": "point", "color": [0, 0, -1]}, ": is negative"),
        ({"type": "point", "color": [0, 0]}, ".color: expected 'array'"),
        ({"type": "point", "range": 0}, ".range: must be greater than 0"),
        (
            {"type": "spot", "spot": {"innerConeAngle": 1}},
            ".spot: needs 0 <= innerConeAngle < outerConeAngle",
        ),
        (
            {"type": "spot", "spot": {"outerConeAngle": 2}},
            ".spot: needs 0 <= innerConeAngle < outerConeAngle",
        ),
    ],
)
def test_names_what_is_wrong_with_a_light(
    light: dict[str, Any], message: str
) -> None:
    with pytest.raises(ModelError) as caught:
        with_lights(light)
    path = "<bytes>: extensions.KHR_lights_punctual.lights[0]"
    assert str(caught.value).startswith(path + message)


def test_nodes_of_the_scene_place_cameras_and_lights() -> None:
    lit = {"extensions": {"KHR_lights_punctual": {"light": 1}}}
    view = {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}
    model = with_lights(
        {"type": "point"},
        {"type": "directional"},
        cameras=[view, view],
        nodes=[{"camera": 1}, lit, {"camera": 0, **lit}],
        scenes=[{"nodes": [0, 1]}],
    )
    nodes, cameras = model.camera_instances()
    assert (nodes.tolist(), cameras.tolist()) == ([0], [1])
    nodes, lights = model.light_instances()
    assert (nodes.tolist(), lights.tolist()) == ([1], [1])
