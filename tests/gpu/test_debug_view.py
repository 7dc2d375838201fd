"""Parts of the light add up, and values have the colours that are stated."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.core.colour import encode_srgb8
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.material.material import AlphaMode, Material
from moka.model import demo_model, quad
from moka.renderer.debug_view import DEBUG_VIEWS
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.pictures import draw_radiance, scene_of, square_camera

pytestmark = pytest.mark.gpu

MATERIAL = Material(
    base_colour_factor=(0.25, 0.5, 0.75, 1.0),
    roughness_factor=0.4,
    metallic_factor=0.8,
    emissive_factor=(1.0, 0.25, 0.0),
)


@pytest.mark.parametrize("ibl", ["split-sum", "filtered"])
@pytest.mark.parametrize("multiscatter", [True, False])
def test_diffuse_and_specular_are_all_the_light(
    device: GraphicsDevice, ibl: str, multiscatter: bool
) -> None:
    scene = Scene()
    scene.add(demo_model())
    scene.environment = load_environment("sky")
    scene.background = "transparent"
    camera = Camera()
    camera.frame(scene.bounds(), 1.0, 0.5, 0.2)
    settings: dict[str, Any] = {"ibl": ibl, "multiscatter": multiscatter}
    # The demo scene emits nothing.
    whole, diffuse, specular = (
        draw_radiance(
            device, scene, camera, (48, 48), light_part=part, **settings
        )
        for part in ("all", "diffuse", "specular")
    )
    np.testing.assert_allclose(
        (diffuse + specular)[..., :3], whole[..., :3], rtol=2e-3, atol=2e-4
    )
    assert diffuse[..., :3].max() > 0.05
    assert specular[..., :3].max() > 0.05
    np.testing.assert_array_equal(diffuse[..., 3], whole[..., 3])


def shown(device: GraphicsDevice, scene: Scene, name: str) -> NDArray[np.uint8]:
    """The middle pixel and the upper left one, RGB."""
    renderer = Renderer(device, (9, 9), RenderSettings())
    commands = CommandList()
    renderer.draw_debug_view(scene, square_camera(), name, commands)
    read = renderer.read_display(commands)
    device.submit(commands).wait()
    renderer.close()
    assert read.data is not None
    pixels: NDArray[np.uint8] = read.data[[4, 0], [4, 0], :3]
    return pixels


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("base colour", encode_srgb8([0.25, 0.5, 0.75])),
        ("roughness", [102] * 3),
        ("metalness", [204] * 3),
        ("normal", [127.5, 127.5, 255]),
        ("occlusion", [255] * 3),
        ("emission", encode_srgb8([0.5, 0.2, 0.0])),
        # As far away as the middle of the scene.
        ("depth", [127.5] * 3),
    ],
)
def test_values_have_their_colours(
    device: GraphicsDevice, name: str, expected: Any
) -> None:
    scene = scene_of([(quad(1.0), MATERIAL, np.eye(4))])
    middle, corner = shown(device, scene, name)
    assert np.abs(middle - np.asarray(expected, float)).max() <= 1
    assert (corner == 20).all()


def test_objects_differ(device: GraphicsDevice) -> None:
    colours = set()
    for count in (1, 2, 3):
        # The one in front is the last of them.
        items = []
        for number in range(count):
            place = np.eye(4)
            place[2, 3] = number
            items.append((quad(1.0), MATERIAL, place))
        middle, _ = shown(device, scene_of(items), "objects")
        colours.add(tuple(middle.tolist()))
    assert len(colours) == 3


def test_every_view_draws(device: GraphicsDevice) -> None:
    scene = scene_of([(quad(1.0), MATERIAL, np.eye(4))])
    for name in DEBUG_VIEWS:
        shown(device, scene, name)


def test_irradiance_is_that_of_a_white_surface_in_uniform_light(
    device: GraphicsDevice,
) -> None:
    """Also of a metal, which has no diffuse base of its own."""
    metal = Material(base_colour_factor=(0.2, 0.5, 0.9, 1), metallic_factor=1)
    scene = scene_of([(quad(1.0), metal, np.eye(4))])
    scene.environment = load_environment("furnace")
    for ibl in ("split-sum", "filtered", "reference"):
        pixels = draw_radiance(
            device,
            scene,
            square_camera(),
            (5, 5),
            light_part="irradiance",
            ibl=ibl,
            **({"reference_samples": 1024} if ibl == "reference" else {}),
        )
        np.testing.assert_allclose(
            pixels[2, 2, :3], 1.0, rtol=5e-3, err_msg=ibl
        )


def test_fresnel_is_f0_seen_from_the_front(device: GraphicsDevice) -> None:
    scene = scene_of([(quad(1.0), MATERIAL, np.eye(4))])
    middle, _ = shown(device, scene, "Fresnel")
    f0 = 0.2 * 0.04 + 0.8 * np.array([0.25, 0.5, 0.75])
    assert np.abs(middle - encode_srgb8(f0).astype(float)).max() <= 1


def test_overdraw_counts_what_is_shaded(device: GraphicsDevice) -> None:
    """What is behind is not: opaque surfaces are drawn front to back."""
    masked = Material(alpha_mode=AlphaMode.MASK, metallic_factor=0.0)
    mesh = quad(1.0)
    colours = []
    for materials in ((MATERIAL,), (MATERIAL, MATERIAL), (MATERIAL, masked)):
        items = []
        for number, material in enumerate(materials):
            place = np.eye(4)
            place[2, 3] = number
            items.append((mesh, material, place))
        middle, _ = shown(device, scene_of(items), "overdraw")
        colours.append(tuple(middle.tolist()))
    # The mask is in front, but drawn after what is opaque.
    assert colours[0] == colours[1] != colours[2]
