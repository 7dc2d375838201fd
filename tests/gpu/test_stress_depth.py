"""Near hides far, from a millimetre to a thousand kilometres at once.

Where a driver has clip control, depth is reversed; where it has not, it is
logarithmic. Both tell surfaces apart that are a hundredth of their distance
from each other, however far from the camera.
"""

from collections.abc import Iterator

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import AlphaMode, Material
from moka.model.cameras import Orthographic, Perspective
from moka.model.geometry import quad
from moka.scene.camera import Camera
from tests.gpu.conftest import open_device
from tests.support.pictures import draw_radiance, placed_at, scene_of
from tests.support.plain_device import open_plain_device

pytestmark = pytest.mark.gpu

SKY = Environment.uniform((0.0, 0.0, 1.0))
NEAR, FAR = 1e-3, 1e6


@pytest.fixture(params=["reversed", "logarithmic"])
def depth_device(request: pytest.FixtureRequest) -> Iterator[GraphicsDevice]:
    """A device with clip control and one without."""
    is_reversed = request.param == "reversed"
    with open_device("egl") if is_reversed else open_plain_device() as device:
        assert device.info.clip_control == is_reversed
        yield device
        device.finish()


def shade(red: float, green: float) -> Material:
    return Material(unlit=True, base_colour_factor=(red, green, 0, 1))


def pairs_of(distances: list[float], gap: float) -> list:
    """Per distance a column of the picture: green just before red.

    The first is drawn last in half of the columns, so that only depth can
    tell. Seen from the origin along -Z at a right angle.
    """
    items = []
    for column, distance in enumerate(distances):
        x = (2 * column + 1) / len(distances) - 1
        pair = [
            (distance, shade(0, 1)),
            (distance * (1 + gap), shade(1, 0)),
        ]
        for depth, material in pair[:: 1 if column % 2 else -1]:
            placement = placed_at(x * distance, 0, -depth)
            width = 1.8 * distance / len(distances)
            placement[0, 0] = placement[1, 1] = width
            items.append((quad(1.0), material, placement))
    return items


@pytest.mark.parametrize("far", [FAR, np.inf])
@pytest.mark.parametrize("samples", [1, 4])
def test_one_picture_holds_a_millimetre_and_a_thousand_kilometres(
    depth_device: GraphicsDevice, samples: int, far: float
) -> None:
    distances = [1.1e-3, 0.01, 1.0, 30.0, 1e3, 2e4, 3e5, 9.8e5]
    camera = Camera(Perspective(np.pi / 2, None, NEAR, far))
    for gap in (0.01, 1e-4):
        scene = scene_of(pairs_of(distances, gap), SKY)
        picture = draw_radiance(
            depth_device, scene, camera, (64, 64), samples=samples
        )
        columns = picture[32, 4::8, :3]
        assert np.allclose(columns, (0, 1, 0)), gap


def test_what_lies_beyond_the_planes_is_cut_off(
    depth_device: GraphicsDevice,
) -> None:
    for distance, is_seen in (
        (0.9 * NEAR, False),
        (1.1 * NEAR, True),
        (0.9 * FAR, True),
        (1.1 * FAR, False),
    ):
        placement = placed_at(0, 0, -distance)
        placement[0, 0] = placement[1, 1] = 10 * distance
        scene = scene_of([(quad(1.0), shade(1, 0), placement)], SKY)
        camera = Camera(Perspective(np.pi / 4, None, NEAR, FAR))
        picture = draw_radiance(depth_device, scene, camera, (4, 4))
        expected = (1, 0, 0) if is_seen else (0, 0, 1)
        assert np.allclose(picture[..., :3], expected), distance


def test_glass_is_hidden_by_what_is_before_it(
    depth_device: GraphicsDevice,
) -> None:
    """Blended surfaces are tested against depth that others have written."""
    glass = Material(
        unlit=True,
        base_colour_factor=(1, 1, 1, 0.5),
        alpha_mode=AlphaMode.BLEND,
    )
    wall = (quad(1e4), shade(0, 0.5), placed_at(0, 0, -1000.0))
    camera = Camera(Perspective(np.pi / 4, None, NEAR, FAR))
    for distance, expected in ((999.0, 0.75), (1001.0, 0.5)):
        items = [wall, (quad(1e4), glass, placed_at(0, 0, -distance))]
        picture = draw_radiance(
            depth_device, scene_of(items, SKY), camera, (4, 4)
        )
        assert np.allclose(picture[..., 1], expected)


def test_parallel_views_have_even_depth(depth_device: GraphicsDevice) -> None:
    camera = Camera(Orthographic(1.0, 1.0, -10.0, 1e4))
    distances = [-9.0, 0.0, 5.0, 9.9e3]
    for nearer in distances:
        items = [
            (quad(2.0), shade(0, 1), placed_at(0, 0, -nearer)),
            (quad(2.0), shade(1, 0), placed_at(0, 0, -nearer - 0.05)),
        ]
        for order in (items, items[::-1]):
            picture = draw_radiance(
                depth_device, scene_of(order, SKY), camera, (4, 4)
            )
            assert np.allclose(picture[..., :3], (0, 1, 0)), nearer


def test_reference_lighting_leaves_the_same_picture(
    depth_device: GraphicsDevice,
) -> None:
    """Its frames mask tiles by depth, whichever way depth runs."""
    camera = Camera(Perspective(np.pi / 2, None, NEAR, FAR))
    scene = scene_of(pairs_of([0.01, 1.0, 1e3, 1e5], 0.01), SKY)
    picture = draw_radiance(
        depth_device,
        scene,
        camera,
        (32, 32),
        ibl="reference",
        reference_samples=16,
        max_error=0.5,
    )
    assert np.allclose(picture[16, 4::8, :3], (0, 1, 0), atol=1e-5)
