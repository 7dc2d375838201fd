"""What is left out for being small could not have been seen."""

import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.graphics.device import GraphicsDevice
from moka.material.material import Material
from moka.model.geometry import sphere
from moka.model.mesh import Primitive
from tests.support.pictures import (
    draw_radiance,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

WHITE = Material(unlit=True)


def test_what_is_larger_than_half_a_pixel_is_drawn_as_ever(
    egl_device: GraphicsDevice,
) -> None:
    """Spheres of 0.6 pixels and more in a picture of 32."""
    random = np.random.default_rng(1)
    items = [
        (sphere(radius), WHITE, placed_at(*random.uniform(-0.9, 0.9, 2)))
        for radius in random.uniform(0.02, 0.2, 40)
    ]
    scene = scene_of(items, background="transparent")
    culled, whole = (
        draw_radiance(
            egl_device, scene, square_camera(), cull_pixels=pixels, samples=4
        )
        for pixels in (0.5, 0.0)
    )
    assert 0.1 < whole[..., 3].mean() < 0.9
    assert np.array_equal(culled, whole)


def test_specks_are_left_out_unless_all_is_asked_for(
    egl_device: GraphicsDevice,
) -> None:
    """One on the centre of a pixel, which it would colour."""
    scene = scene_of(
        [(sphere(0.001), WHITE, placed_at(1 / 32, 1 / 32))],
        background="transparent",
    )
    for pixels, expected in ((0.5, 0), (0.0, 1)):
        picture = draw_radiance(
            egl_device, scene, square_camera(), cull_pixels=pixels
        )
        assert np.count_nonzero(picture[..., 3]) == expected


def test_a_point_is_as_large_as_it_is_drawn(
    egl_device: GraphicsDevice,
) -> None:
    point = Primitive(
        {"POSITION": np.zeros((1, 3), np.float32)}, topology=Topology.POINTS
    )
    scene = scene_of(
        [(point, WHITE, placed_at(1 / 32, 1 / 32))], background="transparent"
    )
    picture = draw_radiance(egl_device, scene, square_camera())
    assert picture[..., 3].any()
