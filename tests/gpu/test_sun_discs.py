"""Suns behind the scene: discs of the right size, place and flux."""

import math

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment, Sun
from moka.material.material import Material
from moka.model.geometry import sphere
from tests.support.pictures import (
    draw_radiance,
    looking,
    placed_at,
    scene_of,
)

pytestmark = pytest.mark.gpu

TOWARDS = np.array([0.48, 0.6, 0.64])
IRRADIANCE = (3.0, 2.0, 1.0)
FOV = math.radians(8)


def picture(
    device: GraphicsDevice,
    radius: float,
    size: int,
    *,
    rotation: float = 0.0,
    environment: Environment | None = None,
    **settings: object,
) -> np.ndarray:
    """The sun amid a picture of 8 degrees; a model elsewhere."""
    x, y, z = TOWARDS.tolist()
    sun = Sun((x, y, z), IRRADIANCE, radius)
    scene = scene_of(
        [(sphere(0.1, 8, 4), Material(), placed_at(*(-5 * TOWARDS)))],
        environment
        or Environment(np.full((16, 32, 3), 0.25, np.float32), (sun,)),
    )
    scene.environment_rotation = rotation
    cosine, sine = math.cos(rotation), math.sin(rotation)
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    camera = looking(turn @ TOWARDS, FOV)
    return draw_radiance(device, scene, camera, (size, size), **settings)


def plane(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Tangents of the angle from the middle, and solid angles."""
    step = 2.0 * math.tan(FOV / 2.0) / size
    offset = (np.arange(size) + 0.5) * step - math.tan(FOV / 2.0)
    x, y = np.meshgrid(offset, offset)
    squared = 1.0 + x * x + y * y
    return np.hypot(x, y), step * step / squared**1.5


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("radius", [0.02, 0.00465, 5e-4, 0.0])
def test_the_disc_has_the_flux_of_its_sun(
    egl_device: GraphicsDevice, radius: float, samples: int
) -> None:
    image = picture(egl_device, radius, 65, samples=samples)
    _, solid_angles = plane(65)
    light = image[..., :3].astype(np.float64) - 0.25
    flux = np.einsum("hwc,hw->c", light, solid_angles)
    # Of less than a pixel it is the sum of a few values of a cone.
    tolerance = 0.01 if radius > 0.002 else 0.1
    assert flux == pytest.approx(IRRADIANCE, rel=tolerance)


@pytest.mark.parametrize("rotation", [0.0, 1.1])
def test_the_disc_is_round_and_in_its_place(
    egl_device: GraphicsDevice, rotation: float
) -> None:
    image = picture(egl_device, 0.02, 128, rotation=rotation)
    distance, _ = plane(128)
    pixel = 2.0 * math.tan(FOV / 2.0) / 128
    inside = distance < math.tan(0.02) - pixel
    outside = distance > math.tan(0.02) + pixel
    radiance = np.array(IRRADIANCE) / (math.pi * math.sin(0.02) ** 2)
    assert image[inside][:, :3] == pytest.approx(
        np.tile(radiance + 0.25, (inside.sum(), 1)), rel=1e-3
    )
    assert image[outside][:, :3] == pytest.approx(0.25, rel=1e-4)


def test_a_uniform_sky_shows_its_sun(egl_device: GraphicsDevice) -> None:
    x, y, z = TOWARDS.tolist()
    environment = Environment(
        np.full((1, 1, 3), 0.25, np.float32),
        (Sun((x, y, z), IRRADIANCE, 0.02),),
    )
    image = picture(egl_device, 0.02, 32, environment=environment)
    assert image[16, 16, 0] > 1e3
    assert image[0, 0, :3] == pytest.approx(0.25)


def test_a_sun_found_in_a_map_is_seen_as_it_was(
    egl_device: GraphicsDevice,
) -> None:
    """Only suns that are not in the map become discs."""
    pixels = np.full((128, 256, 3), 0.25, np.float32)
    u = 0.5 + math.atan2(TOWARDS[2], TOWARDS[0]) / (2.0 * math.pi)
    v = math.acos(TOWARDS[1]) / math.pi
    pixels[int(v * 128), int(u * 256)] = 1e4
    on, off = (
        picture(egl_device, 0.0, 32, environment=Environment(pixels), suns=suns)
        for suns in ("auto", "off")
    )
    assert np.array_equal(on, off)
    assert 1e3 < on.max() <= 1e4


@pytest.mark.parametrize("count", [4, 5, 9])
def test_each_of_many_suns_is_seen(
    egl_device: GraphicsDevice, count: int
) -> None:
    """Up to four come from the vertices, more of them from the block."""
    up = np.array([0.0, 1.0, 0.0])
    right = np.cross(TOWARDS, up)
    offsets = np.linspace(-0.05, 0.05, count)[:, None]
    directions = TOWARDS + offsets * right / np.linalg.norm(right)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    sky = np.full((16, 32, 3), 0.25, np.float32)
    suns = tuple(
        Sun(tuple(direction), (0.001 * (i + 1), 0.002, 0.003), 0.004)
        for i, direction in enumerate(directions.tolist())
    )
    together, *alone = (
        picture(egl_device, 0, 96, environment=Environment(sky, some))
        for some in (suns, *((sun,) for sun in suns))
    )
    expected = 0.25 + sum(image[..., :3] - 0.25 for image in alone)
    assert together[..., :3] == pytest.approx(expected, rel=1e-4)
    assert all(image.max() > 20.0 for image in alone)
