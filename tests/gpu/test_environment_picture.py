"""Sky and reflections stand where the contract says, on all six axes."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment, Sun
from moka.material.material import Material, Texture
from moka.model.geometry import cube, quad, sphere
from tests.support.pictures import (
    draw_radiance,
    draw_with_display,
    encoded,
    looking,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

AXES = {
    "+X": (1, 0, 0),
    "-X": (-1, 0, 0),
    "+Y": (0, 1, 0),
    "-Y": (0, -1, 0),
    "+Z": (0, 0, 1),
    "-Z": (0, 0, -1),
}


def axis_map(height: int = 64) -> NDArray[np.float32]:
    """Each direction shows the axis it is nearest to, as a number 1 to 6.

    From the contract's formulas for u and v, and nothing of moka's.
    """
    v, u = np.meshgrid(
        (np.arange(height) + 0.5) / height,
        (np.arange(2 * height) + 0.5) / (2 * height),
        indexing="ij",
    )
    polar, azimuth = v * math.pi, (u - 0.5) * 2 * math.pi
    directions = np.stack(
        [
            np.sin(polar) * np.cos(azimuth),
            np.cos(polar),
            np.sin(polar) * np.sin(azimuth),
        ],
        axis=-1,
    )
    axes = np.array(list(AXES.values()), np.float64)
    number = (directions @ axes.T).argmax(axis=-1) + 1
    return np.repeat(number[..., None], 3, axis=-1).astype(np.float32)


@pytest.mark.parametrize("name", AXES)
def test_the_background_shows_each_axis_where_it_is(
    device: GraphicsDevice, name: str
) -> None:
    scene = scene_of([], Environment(axis_map()))
    picture = draw_radiance(device, scene, looking(AXES[name]))
    expected = list(AXES).index(name) + 1
    assert np.allclose(picture[:, :, :3], expected, atol=1e-3)


@pytest.mark.parametrize("name", AXES)
def test_a_mirror_shows_what_is_behind_the_camera(
    device: GraphicsDevice, name: str
) -> None:
    """A smooth white metal facing the camera reflects straight back."""
    direction = np.array(AXES[name], np.float64)
    camera = looking(-direction, math.radians(2), 3 * direction)
    mirror = Material(metallic_factor=1.0, roughness_factor=0.0)
    facing = np.array(camera.transform.world_matrix)
    facing[:3, 3] = 0
    scene = scene_of([(quad(1.0), mirror, facing)], Environment(axis_map()))
    picture = draw_radiance(device, scene, camera)
    expected = list(AXES).index(name) + 1
    assert np.allclose(picture[:, :, :3], expected, rtol=2e-3)


def test_a_diffuse_surface_is_lit_from_the_side_it_faces(
    egl_device: GraphicsDevice,
) -> None:
    """Light from above only: the floor gets all of it, the ceiling none."""
    pixels = np.zeros((64, 128, 3), np.float32)
    pixels[:32] = 1.0
    matte = Material(metallic_factor=0.0, roughness_factor=1.0)
    shades = []
    for name in ("+Y", "+X", "-Y"):
        direction = np.array(AXES[name], np.float64)
        camera = looking(-direction, math.radians(2), 3 * direction)
        facing = np.array(camera.transform.world_matrix)
        facing[:3, 3] = 0
        scene = scene_of([(quad(1.0), matte, facing)], Environment(pixels))
        picture = draw_radiance(egl_device, scene, camera)
        shades.append(float(picture[16, 16, 0]))
    # Irradiance / pi is 1 facing up, 1/2 facing the horizon, 0 below.
    up, side, down = shades
    assert up == pytest.approx(1.0, abs=0.02)
    assert side == pytest.approx(0.5, abs=0.03)
    assert down == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("turn", [0, 90, 200])
def test_rotation_turns_the_sky_counter_clockwise_seen_from_above(
    egl_device: GraphicsDevice, turn: float
) -> None:
    """What was at +X appears where +X goes when turned about +Y."""
    scene = scene_of([], Environment(axis_map()))
    scene.environment_rotation = math.radians(turn)
    angle = math.radians(turn)
    # Counter-clockwise from above, with +Z towards the viewer's feet, takes
    # +X to -Z after a quarter.
    where = (math.cos(angle), 0.0, -math.sin(angle))
    picture = draw_radiance(egl_device, scene, looking(where))
    assert np.allclose(picture[:, :, :3], 1, atol=1e-3)
    mirror = Material(metallic_factor=1.0, roughness_factor=0.0)
    camera = looking(-np.array(where), math.radians(2), 3 * np.array(where))
    facing = np.array(camera.transform.world_matrix)
    facing[:3, 3] = 0
    scene.add(scene_of([(quad(1.0), mirror, facing)]).models[0].model)
    picture = draw_radiance(egl_device, scene, camera)
    assert np.allclose(picture[:, :, :3], 1, rtol=2e-3)


def test_intensity_multiplies_sky_and_light(
    egl_device: GraphicsDevice,
) -> None:
    matte = Material(metallic_factor=0.0, roughness_factor=1.0)
    for items in ([], [(quad(4.0), matte, np.eye(4))]):
        scene = scene_of(items, Environment.uniform((1.0, 0.5, 0.25)))
        single = draw_radiance(egl_device, scene, square_camera())
        scene.environment_intensity = 3.0
        triple = draw_radiance(egl_device, scene, square_camera())
        assert np.allclose(triple[..., :3], 3 * single[..., :3], rtol=1e-5)


def test_the_sky_is_sharp_and_unfiltered(egl_device: GraphicsDevice) -> None:
    """The radiance of a texel comes back as it is, however bright."""
    pixels = np.full((32, 64, 3), 0.5, np.float32)
    pixels[15:17, 31:33] = (1e6, 2e6, 3e5)
    camera = looking((1, 0, 0), math.radians(1))
    picture = draw_radiance(
        egl_device, scene_of([], Environment(pixels)), camera, (8, 8)
    )
    assert np.allclose(picture[..., :3], (1e6, 2e6, 3e5), rtol=1e-5)


def test_without_an_environment_the_picture_is_black_and_opaque(
    egl_device: GraphicsDevice,
) -> None:
    picture = draw_radiance(egl_device, scene_of([]), square_camera())
    assert np.array_equal(picture[0, 0], [0, 0, 0, 1])


def test_a_background_colour_leaves_exactly_as_it_was_given(
    egl_device: GraphicsDevice,
) -> None:
    scene = scene_of([], Environment.uniform((1, 1, 1)), "#336699")
    for exposure in (0.0, 3.0):
        _, display = draw_with_display(
            egl_device, scene, square_camera(), exposure=exposure
        )
        assert (display == [0x33, 0x66, 0x99, 255]).all()


def test_a_transparent_background_keeps_coverage(
    egl_device: GraphicsDevice,
) -> None:
    matte = Material(unlit=True, base_colour_factor=(0.2, 0.4, 0.8, 1))
    scene = scene_of(
        [(quad(1.0), matte, np.eye(4))],
        Environment.uniform((1, 1, 1)),
        "transparent",
    )
    radiance, display = draw_with_display(
        egl_device, scene, square_camera(), tone_map="none"
    )
    assert np.allclose(radiance[16, 16], (0.2, 0.4, 0.8, 1), atol=1e-6)
    assert not radiance[0, 0].any()
    assert display[0, 0, 3] == 0
    assert display[16, 16, 3] == 255


def test_a_sun_lights_as_a_directional_light_and_turns_with_the_sky(
    egl_device: GraphicsDevice,
) -> None:
    """Lambert under a sun overhead: colour / pi times its irradiance."""
    dark = np.zeros((1, 1, 3), np.float32)
    sun = Sun((1.0, 0.0, 0.0), (3.0, 2.0, 1.0))
    scene = scene_of(
        [
            (
                sphere(1.0, 64, 32),
                Material(
                    base_colour_factor=(0.5, 0.5, 0.5, 1),
                    metallic_factor=0.0,
                    roughness_factor=1.0,
                ),
                np.eye(4),
            )
        ],
        Environment(dark, (sun,)),
        "transparent",
    )
    # Turned so that it shines from +Z, where the camera is.
    scene.environment_rotation = math.radians(-90)
    picture = draw_radiance(
        egl_device, scene, square_camera(), (33, 33), multiscatter=False
    )
    facing = picture[16, 16, :3]
    lambert = 0.96 * 0.5 / math.pi
    # GGX at roughness 1 adds D V F = 1/pi * 1/4 * 0.04 at the centre.
    specular = 0.04 / (4 * math.pi)
    expected = (lambert + specular) * np.array([3, 2, 1])
    assert facing == pytest.approx(expected, rel=5e-3)


def test_a_sun_is_occluded_like_the_rest_of_its_environment(
    egl_device: GraphicsDevice,
) -> None:
    """So that a map looks alike with its sun in it and taken out."""
    half = np.full((1, 1, 3), 128, np.uint8)
    sun = Sun((0.0, 0.0, 1.0), (3.0, 3.0, 3.0))
    shades = []
    for strength in (0.0, 1.0):
        material = Material(
            metallic_factor=0.0,
            occlusion_texture=Texture(encoded(half)),
            occlusion_strength=strength,
        )
        scene = scene_of(
            [(quad(2.0), material, np.eye(4))],
            Environment(np.zeros((1, 1, 3), np.float32), (sun,)),
        )
        picture = draw_radiance(egl_device, scene, square_camera())
        shades.append(float(picture[16, 16, 0]))
    assert shades[1] == pytest.approx(shades[0] * 128 / 255, rel=1e-3)


def test_an_environment_that_is_off_is_seen_and_lights_nothing(
    egl_device: GraphicsDevice,
) -> None:
    uniform = Environment(np.full((4, 8, 3), 2.0, np.float32))
    block = cube(0.5)
    scene = scene_of([(block, Material(), np.eye(4))], uniform)
    camera = looking((0, 0, -1), math.radians(40), (0, 0, 3))
    lit, dark = (
        draw_radiance(egl_device, scene, camera, (16, 16), ibl=ibl)
        for ibl in ("split-sum", "off")
    )
    np.testing.assert_allclose(dark[0, 0, :3], 2.0, rtol=1e-3)
    np.testing.assert_allclose(lit[0, 0, :3], 2.0, rtol=1e-3)
    assert lit[8, 8, :3].min() > 0.5
    assert dark[8, 8, :3].max() == 0.0


@pytest.mark.parametrize("background", ["environment", (0.2, 0.5, 0.7)])
def test_a_sky_alone_is_the_same_with_more_samples(
    egl_device: GraphicsDevice, background: object
) -> None:
    sun = Sun((0.0, 0.0, -1.0), (9.0, 8.0, 7.0), 0.05)
    scene = scene_of([], background=background)
    scene.environment = Environment(axis_map(), suns=(sun,))
    one, four = (
        draw_with_display(egl_device, scene, square_camera(), samples=samples)
        for samples in (1, 4)
    )
    for first, second in zip(one, four, strict=True):
        assert np.array_equal(first, second)
