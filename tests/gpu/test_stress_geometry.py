"""Geometry at the limits: directions that are none, scales, distances.

What cannot be meant gets the picture of what it most likely stands for; all
else looks the same at any scale and anywhere in the world.
"""

import contextlib
import math

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import MokaError
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material, Texture
from moka.model.cameras import Orthographic, Perspective
from moka.model.geometry import cube, quad, sphere
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Primitive
from moka.model.tangents import with_tangents
from moka.scene.camera import Camera
from moka.scene.camera_choice import Orbit, choose_camera
from moka.scene.scene import Scene
from tests.support.pictures import (
    draw_radiance,
    encoded,
    looking,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

MODES = {
    "split-sum": {},
    "filtered": {"ibl": "filtered"},
    "reference": {"ibl": "reference", "reference_samples": 16},
}
MATTE = Material(metallic_factor=0.0, roughness_factor=0.5)
BUMP = Texture(encoded(np.array([[[200, 128, 230]]], np.uint8)))
BUMPY = Material(metallic_factor=0.0, roughness_factor=0.5, normal_texture=BUMP)
SQUARE = quad(1.5)
COUNT = SQUARE.vertex_count


def sky() -> Environment:
    """Brighter above and to the right."""
    generator = np.random.default_rng(6)
    pixels = generator.uniform(0.5, 1.0, (16, 32, 3))
    pixels[:8] += 1.0
    pixels[:, 8:24] += 0.5
    return Environment(pixels)


def sun(lux: float = math.pi) -> list:
    """From the upper right of a camera that looks along -Z."""
    camera = looking((-0.4, -0.5, -0.77))
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=lux)
    return [(light, camera.transform.world_matrix)]


def picture_of(
    device: GraphicsDevice,
    primitive: Primitive,
    material: Material = MATTE,
    matrix: ArrayLike | None = None,
    camera: Camera | None = None,
    size: tuple[int, int] = (24, 24),
    **settings: object,
) -> NDArray[np.float32]:
    scene = scene_of(
        [(primitive, material, np.eye(4) if matrix is None else matrix)],
        sky(),
        "transparent",
        sun(),
    )
    picture = draw_radiance(
        device, scene, camera or square_camera(), size, **settings
    )
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()
    return picture


def square_with(**attributes: ArrayLike) -> Primitive:
    """The square with one value of an attribute for all its vertices."""
    values = {
        name: np.tile(np.asarray(value, float), (COUNT, 1))
        for name, value in attributes.items()
    }
    return Primitive({**SQUARE.attributes, **values}, SQUARE.indices)


def square_without(*names: str) -> Primitive:
    kept = {k: v for k, v in SQUARE.attributes.items() if k not in names}
    return Primitive(kept, SQUARE.indices)


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
@pytest.mark.parametrize(
    "normal",
    [(0, 0, 0), (math.nan,) * 3, (math.inf,) * 3, (0, 0, -0.0)],
)
def test_a_normal_that_is_none_becomes_that_of_the_triangle(
    egl_device: GraphicsDevice, normal: tuple[float, ...], mode: dict
) -> None:
    flat = picture_of(egl_device, square_without("NORMAL"), **mode)
    shown = picture_of(egl_device, square_with(NORMAL=normal), **mode)
    assert np.allclose(shown, flat, atol=1e-6)
    assert flat[12, 12, 3] == 1.0


@pytest.mark.parametrize("length", [1e-37, 1e-30, 1e-20, 1e20, 1e30, 1e38])
def test_a_normal_of_any_length_is_a_direction(
    egl_device: GraphicsDevice, length: float
) -> None:
    tilted = np.array([0.6, 0.0, 0.8])
    expected = picture_of(egl_device, square_with(NORMAL=tilted))
    shown = picture_of(egl_device, square_with(NORMAL=length * tilted))
    assert np.allclose(shown, expected, rtol=1e-4)


def test_normals_that_cancel_out_do_not_break_the_middle(
    egl_device: GraphicsDevice,
) -> None:
    normals = np.array([(0, 0, 1), (0, 0, -1), (0, 0, 1), (0, 0, -1)])
    attributes = {**SQUARE.attributes, "NORMAL": normals}
    for mode in MODES.values():
        picture_of(
            egl_device,
            Primitive(attributes, SQUARE.indices),
            size=(33, 33),
            **mode,
        )


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
@pytest.mark.parametrize(
    "attributes",
    [
        {"TANGENT": (0, 0, 0, 0)},
        {"TANGENT": (math.nan,) * 4},
        {"TANGENT": (math.inf,) * 4},
        {"TEXCOORD_0": (0.5, 0.5)},
        {"TEXCOORD_0": (math.nan, math.nan)},
        {"NORMAL": (0, 0, 0), "TANGENT": (0, 0, 0, 0)},
    ],
    ids=lambda attributes: "-".join(map(str, attributes.items())),
)
def test_without_a_frame_a_normal_map_bends_nothing(
    egl_device: GraphicsDevice, attributes: dict, mode: dict
) -> None:
    """Nor does it where texture coordinates are missing altogether."""
    plain = picture_of(egl_device, SQUARE, **mode)
    shown = picture_of(egl_device, square_with(**attributes), BUMPY, **mode)
    assert np.allclose(shown, plain, rtol=1e-3)
    bare = square_without("TEXCOORD_0")
    assert np.allclose(picture_of(egl_device, bare, BUMPY, **mode), plain)


def test_a_tangent_along_the_normal_is_finite(
    egl_device: GraphicsDevice,
) -> None:
    for texel in ((200, 128, 230), (128, 128, 128), (128, 128, 0)):
        bump = Texture(encoded(np.array([[texel]], np.uint8)))
        material = Material(normal_texture=bump)
        for tangent in ((0, 0, 1, 1), (0, 0, -1, -1), (1, 0, 0, 0)):
            picture_of(egl_device, square_with(TANGENT=tangent), material)


@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1e6, 1e30])
def test_texture_coordinates_of_any_size_bend_normals_alike(
    egl_device: GraphicsDevice, scale: float
) -> None:
    uv = SQUARE.attributes["TEXCOORD_0"] * scale
    scaled = Primitive({**SQUARE.attributes, "TEXCOORD_0": uv}, SQUARE.indices)
    expected = picture_of(egl_device, SQUARE, BUMPY)
    shown = picture_of(egl_device, scaled, BUMPY)
    assert np.allclose(shown, expected, rtol=2e-3)


def test_mirrored_coordinates_with_and_without_tangents_agree(
    egl_device: GraphicsDevice,
) -> None:
    uv = SQUARE.attributes["TEXCOORD_0"] * (-1.0, 1.0)
    mirrored = Primitive(
        {**SQUARE.attributes, "TEXCOORD_0": uv}, SQUARE.indices
    )
    # Vertices without normals get their frame from the shader.
    bare = Primitive(
        {k: v for k, v in mirrored.attributes.items() if k != "NORMAL"},
        mirrored.indices,
    )
    by_derivatives = picture_of(egl_device, bare, BUMPY)
    by_vertices = picture_of(egl_device, with_tangents(mirrored), BUMPY)
    assert np.allclose(by_derivatives, by_vertices, rtol=1e-4)
    upright = picture_of(egl_device, SQUARE, BUMPY)
    assert np.abs(by_derivatives - upright).max() > 0.05


def test_a_material_whose_textures_find_no_coordinates(
    egl_device: GraphicsDevice,
) -> None:
    texture = Texture(encoded(np.full((1, 1, 4), 30, np.uint8)))
    textures = dict.fromkeys(
        (
            "base_colour_texture",
            "metallic_roughness_texture",
            "normal_texture",
            "occlusion_texture",
            "emissive_texture",
        ),
        texture,
    )
    bare = square_without("TEXCOORD_0")
    full = Material(emissive_factor=(0.1, 0.2, 0.3), **textures)
    plain = Material(emissive_factor=(0.1, 0.2, 0.3))
    assert np.allclose(
        picture_of(egl_device, bare, full),
        picture_of(egl_device, bare, plain),
    )


def test_a_model_without_materials(egl_device: GraphicsDevice) -> None:
    scene = scene_of([(SQUARE, None, np.eye(4))], sky())
    picture = draw_radiance(egl_device, scene, square_camera())
    assert np.isfinite(picture).all()
    assert picture[16, 16, 0] > 0.1


SCALES = [1e-18, 1e-6, 1e6, 1e17]


def camera_at(scale: float) -> Camera:
    camera = Camera(Perspective(0.5, None, 0.1 * scale, 100 * scale))
    camera.transform.translate((0, 0, 5 * scale))
    return camera


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("has_normals", [True, False])
@pytest.mark.parametrize("material", [MATTE, BUMPY], ids=["plain", "bumpy"])
def test_a_thing_of_any_size_looks_the_same(
    egl_device: GraphicsDevice,
    scale: float,
    mirrored: bool,
    has_normals: bool,
    material: Material,
) -> None:
    ball = sphere(0.9, 16, 8)
    if not has_normals:
        ball = Primitive(
            {k: v for k, v in ball.attributes.items() if k != "NORMAL"},
            ball.indices,
        )
    side = -1.0 if mirrored else 1.0

    def shown(size: float) -> NDArray[np.float32]:
        matrix = np.diag([side * size, size, size, 1.0])
        return picture_of(egl_device, ball, material, matrix, camera_at(size))

    difference = np.abs(shown(scale) - shown(1.0))
    # Single pixels at an edge may fall to the other side.
    assert np.quantile(difference, 0.99) < 2e-3


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
@pytest.mark.parametrize("scale", [1e-30, 1e-20, 1e20, 1e30, 1e38])
def test_a_thing_of_absurd_size_is_finite(
    egl_device: GraphicsDevice, scale: float, mode: dict
) -> None:
    matrix = np.diag([scale, scale, scale, 1.0])
    for camera in (camera_at(scale), square_camera()):
        picture_of(egl_device, sphere(0.5), MATTE, matrix, camera, **mode)


@pytest.mark.parametrize(
    "scales",
    [
        (0, 0, 0),
        (1, 1, 0),
        (1, 0, 1),
        (0, 1, 0),
        (-1, -1, -1),
        (-1, 1, 1),
        (1e6, 1e-6, 1),
        (1e-6, 1, 1e6),
        (-1e6, 1e6, 1e6),
        (1e-20, 1, 1),
    ],
)
def test_a_thing_of_uneven_or_no_size_is_finite(
    egl_device: GraphicsDevice, scales: tuple[float, float, float]
) -> None:
    for primitive in (sphere(0.5), cube(0.5), SQUARE):
        for material in (MATTE, BUMPY):
            picture_of(egl_device, primitive, material, np.diag([*scales, 1.0]))


def test_a_flattened_thing_keeps_its_normals(
    egl_device: GraphicsDevice,
) -> None:
    flattened = np.diag([1.0, 1.0, 0.0, 1.0])
    shown = picture_of(egl_device, SQUARE, MATTE, flattened)
    assert np.allclose(shown, picture_of(egl_device, SQUARE), rtol=1e-5)


@pytest.mark.parametrize("distance", [1e7, 1e12])
def test_it_looks_the_same_far_from_the_origin(
    egl_device: GraphicsDevice, distance: float
) -> None:
    """As exactly as float64 can place it: within 2e-4 m at 1e12 m."""
    pictures = []
    for offset in (np.zeros(3), distance * np.array([1.0, -0.5, 0.25])):
        offset = np.round(offset)
        camera = looking((0, 0, -1), 0.5, offset + np.array([0, 0, 5]))
        pictures.append(
            picture_of(
                egl_device,
                sphere(0.9, 32, 16),
                BUMPY,
                placed_at(*offset),
                camera,
            )
        )
    difference = np.abs(pictures[0] - pictures[1])
    assert np.quantile(difference, 0.99) < 2e-3


def test_an_empty_scene(egl_device: GraphicsDevice) -> None:
    for environment in (None, sky()):
        for background in ("environment", "transparent", "#336699"):
            for mode in MODES.values():
                scene = Scene()
                scene.environment = environment
                scene.background = background
                camera = choose_camera(scene, None, 1.0)
                picture = draw_radiance(
                    egl_device, scene, camera, (4, 4), **mode
                )
                assert np.isfinite(picture).all()


CAMERAS = {
    "at the centre of the bounds": looking((0, 0, -1), 1.0),
    "on the surface": looking((0, 0, -1), 1.0, (0.49, 0, 0)),
    "inside, looking down": looking((0, -1, 0), 1.0, (0, 0.2, 0)),
    "half a turn wide": looking((1, 0, 0), math.pi - 1e-6),
    "a nanoradian wide": looking((1, 0, 0), 1e-9, (-3, 0, 0)),
    "a picometre high": square_camera(1e-12),
    "a trillion metres high": square_camera(1e12),
    "1e38 m high": Camera(Orthographic(1, 1e38, -1e30, 1e30)),
    "from 1e-30 to 1e30": Camera(Perspective(1.0, None, 1e-30, 1e30)),
    "beyond 1e30": Camera(Perspective(1.0, None, 1e30, math.inf)),
    "nearly no depth": Camera(Perspective(1.0, None, 1.0, 1.0 + 1e-15)),
}


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS.keys())
def test_a_camera_anywhere(egl_device: GraphicsDevice, camera: Camera) -> None:
    both = Material(metallic_factor=0.0, double_sided=True)
    for mode in MODES.values():
        for material in (MATTE, both):
            picture_of(egl_device, sphere(0.5), material, camera=camera, **mode)


@pytest.mark.parametrize("size", [(1, 1), (16384, 1), (1, 16384), (3, 2)])
@pytest.mark.parametrize("samples", [1, 4])
def test_a_picture_of_any_shape(
    egl_device: GraphicsDevice, size: tuple[int, int], samples: int
) -> None:
    scene = scene_of([(sphere(0.5), MATTE, np.eye(4))], sky(), lights=sun())
    camera = choose_camera(scene, None, size[0] / size[1])
    picture = draw_radiance(egl_device, scene, camera, size, samples=samples)
    assert picture.shape == (size[1], size[0], 4)
    assert np.isfinite(picture).all()


@pytest.mark.parametrize("extent", [1e-38, 1e-30, 1e-20, 1e18, 1e30, 3e38])
@pytest.mark.parametrize("choice", [None, Orbit(1.0, 0.5)])
def test_positions_at_the_ends_of_float32(
    egl_device: GraphicsDevice, extent: float, choice: Orbit | None
) -> None:
    """A finite picture, or an error that says why there is none."""
    positions = SQUARE.attributes["POSITION"] * np.float32(extent)
    primitive = Primitive(
        {**SQUARE.attributes, "POSITION": positions}, SQUARE.indices
    )
    scene = scene_of([(primitive, MATTE, np.eye(4))], sky(), lights=sun())
    with contextlib.suppress(MokaError):
        camera = choose_camera(scene, choice, 1.0)
        picture = draw_radiance(egl_device, scene, camera, (8, 8))
        assert np.isfinite(picture).all()
        assert (picture >= 0.0).all()
