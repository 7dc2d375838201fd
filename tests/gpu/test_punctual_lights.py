"""Lamps in pictures obey radiometry: inverse square, cosine, flux.

The surface is a white metal of roughness 1 without energy compensation, seen
along its normal: D is 1 / pi, V is 0.5 / (n.l + 1) and F is 1, so that a
pixel's radiance tells its irradiance by hand.
"""

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.material.material import Material
from moka.model.geometry import quad
from moka.model.lights import LightKind, PunctualLight
from moka.radiometry import (
    flux_from_irradiance,
    irradiance_at_distance,
    point_flux,
    spot_flux,
)
from tests.support.pictures import (
    draw_radiance,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

MATERIAL = Material(metallic_factor=1.0, roughness_factor=1.0)


class Plane:
    """A square in the xy plane around the origin, and its pixels."""

    def __init__(self, half: float, size: int) -> None:
        self.half, self.size = half, size
        centres = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) * half
        self.x, self.y = np.meshgrid(centres, -centres)
        self.pixel_area = (2.0 * half / size) ** 2

    def distance_and_cosine(
        self, height: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """From a point above the middle."""
        distance = np.sqrt(self.x**2 + self.y**2 + height**2)
        return distance, height / distance

    def irradiance(
        self,
        device: GraphicsDevice,
        light: PunctualLight,
        height: float,
        cosine: np.ndarray | float,
    ) -> np.ndarray:
        """Of every pixel (size, size, 3), under a light that looks down."""
        scene = scene_of(
            [(quad(2.0 * self.half), MATERIAL, np.eye(4))],
            lights=[(light, placed_at(z=height))],
        )
        picture = draw_radiance(
            device,
            scene,
            square_camera(self.half, 2.0),
            (self.size, self.size),
            multiscatter=False,
        )
        scale = 2.0 * np.pi * (np.asarray(cosine) + 1.0)
        return picture[..., :3] * scale[..., np.newaxis]


@pytest.mark.parametrize("kind", [LightKind.POINT, LightKind.SPOT])
def test_light_falls_with_the_square_of_the_distance(
    egl_device: GraphicsDevice, kind: LightKind
) -> None:
    light = PunctualLight(
        kind, (1.0, 0.5, 0.25), intensity=80.0, inner_cone_angle=0.2
    )
    for height in (0.1, 1.0, 2.0, 300.0):
        plane = Plane(0.01 * height, 2)
        distance, cosine = plane.distance_and_cosine(height)
        value = plane.irradiance(egl_device, light, height, cosine)
        expected = irradiance_at_distance(80.0, distance, cosine)
        colour = np.array(light.colour)
        assert value == pytest.approx(expected[..., None] * colour, rel=1e-4)


def test_light_falls_with_the_cosine_to_the_horizon(
    egl_device: GraphicsDevice,
) -> None:
    plane = Plane(20.0, 32)
    distance, cosine = plane.distance_and_cosine(0.5)
    light = PunctualLight(LightKind.POINT, intensity=7.0)
    value = plane.irradiance(egl_device, light, 0.5, cosine)
    expected = irradiance_at_distance(7.0, distance, cosine)
    assert value[..., 0] == pytest.approx(expected, rel=1e-3)


def test_a_directional_light_is_in_lux(egl_device: GraphicsDevice) -> None:
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=9.0)
    value = Plane(1.0, 2).irradiance(egl_device, light, 1.0, 1.0)
    assert value == pytest.approx(9.0, rel=1e-4)


@pytest.mark.parametrize(("inner", "outer"), [(0.0, 0.7), (0.5, 0.8)])
def test_a_plane_takes_all_the_flux_of_a_spot(
    egl_device: GraphicsDevice, inner: float, outer: float
) -> None:
    light = PunctualLight(
        LightKind.SPOT,
        intensity=5.0,
        inner_cone_angle=inner,
        outer_cone_angle=outer,
    )
    plane = Plane(1.1, 128)
    cosine = plane.distance_and_cosine(1.0)[1]
    irradiance = plane.irradiance(egl_device, light, 1.0, cosine)[..., 0]
    area = np.full_like(irradiance, plane.pixel_area)
    flux = flux_from_irradiance(irradiance, area)
    # Pixels are points of the integrand.
    assert flux == pytest.approx(spot_flux(5.0, inner, outer), rel=1e-3)


def test_a_square_takes_its_share_of_the_flux_of_a_point(
    egl_device: GraphicsDevice,
) -> None:
    """A face of a cube around the light: a sixth."""
    light = PunctualLight(LightKind.POINT, intensity=5.0)
    plane = Plane(1.0, 64)
    cosine = plane.distance_and_cosine(1.0)[1]
    irradiance = plane.irradiance(egl_device, light, 1.0, cosine)[..., 0]
    area = np.full_like(irradiance, plane.pixel_area)
    flux = flux_from_irradiance(irradiance, area)
    assert flux == pytest.approx(point_flux(5.0) / 6.0, rel=1e-3)
