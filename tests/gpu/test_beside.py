"""A renderer beside another one: the same scene, made otherwise."""

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.handles import ResourceKind
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.model import demo_model
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene

pytestmark = pytest.mark.gpu

SIZE = (48, 32)


@pytest.fixture
def scene() -> Scene:
    made = Scene()
    made.add(demo_model())
    made.environment = load_environment("studio")
    return made


@pytest.fixture
def camera(scene: Scene) -> Camera:
    made = Camera()
    made.frame(scene.bounds(), 1.5, 0.4, 0.2)
    return made


def shown(
    renderer: Renderer, scene: Scene, camera: Camera
) -> NDArray[np.uint8]:
    commands = CommandList()
    renderer.draw(scene, camera, commands)
    read = renderer.read_display(commands)
    renderer.device.submit(commands).wait()
    assert read.data is not None
    pixels: NDArray[np.uint8] = read.data
    return pixels


def test_it_shares_and_draws_what_it_would_draw_alone(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera
) -> None:
    other = RenderSettings(brdf="karis", samples=1)
    alone = Renderer(egl_device, SIZE, other)
    expected = shown(alone, scene, camera)
    alone.close()
    main = Renderer(egl_device, SIZE)
    before = shown(main, scene, camera)
    kinds = (ResourceKind.MESH, ResourceKind.TEXTURE)
    meshes, textures = map(egl_device.count, kinds)
    beside = Renderer(egl_device, SIZE, other, beside=main)
    np.testing.assert_array_equal(shown(beside, scene, camera), expected)
    assert egl_device.count(ResourceKind.MESH) == meshes
    # Two targets and depth, and the maps of the light; none of the model's.
    with_beside = egl_device.count(ResourceKind.TEXTURE)
    np.testing.assert_array_equal(shown(main, scene, camera), before)
    assert egl_device.count(ResourceKind.TEXTURE) == with_beside
    beside.release_targets()
    assert textures < egl_device.count(ResourceKind.TEXTURE) < with_beside
    np.testing.assert_array_equal(shown(beside, scene, camera), expected)
    beside.close()
    np.testing.assert_array_equal(shown(main, scene, camera), before)
    main.close()


def test_models_may_come_and_go_under_both(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera
) -> None:
    main = Renderer(egl_device, SIZE)
    beside = Renderer(egl_device, SIZE, beside=main)
    for _ in range(2):
        for renderer in (beside, main):
            shown(renderer, scene, camera)
        scene.remove(scene.models[0])
        shown(beside, scene, camera)
        scene.add(demo_model())
    np.testing.assert_array_equal(
        shown(beside, scene, camera), shown(main, scene, camera)
    )
    main.close()


@pytest.mark.parametrize("samples", [1, 4])
def test_an_area_is_all_that_is_drawn(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera, samples: int
) -> None:
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=samples))
    whole = shown(renderer, scene, camera)
    scene.environment_intensity = 0.0
    dark = shown(renderer, scene, camera)
    scene.environment_intensity = 1.0
    renderer.area = (10, 5, 20, 15)
    part = shown(renderer, scene, camera)
    renderer.area = None
    inside = np.zeros(part.shape[:2], bool)
    inside[5:20, 10:30] = True
    np.testing.assert_array_equal(part[inside], whole[inside])
    np.testing.assert_array_equal(part[~inside], dark[~inside])
    assert (whole[~inside] != dark[~inside]).any()
    renderer.close()


def completed(
    renderer: Renderer, scene: Scene, camera: Camera
) -> tuple[NDArray[np.uint8], int]:
    """The picture with all its samples, and how many frames it took."""
    frames = 1
    found = shown(renderer, scene, camera)
    while not renderer.is_complete:
        found = shown(renderer, scene, camera)
        frames += 1
    return found, frames


def test_reference_lighting_of_an_area_is_a_part_of_the_whole(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera
) -> None:
    size = (128, 96)
    settings = RenderSettings(ibl="reference", reference_samples=64)
    renderer = Renderer(egl_device, size, settings)
    whole, frames = completed(renderer, scene, camera)

    renderer = Renderer(egl_device, size, settings)
    renderer.area = (64, 0, 64, 96)
    part, frames_of_part = completed(renderer, scene, camera)
    np.testing.assert_array_equal(part[:, 64:], whole[:, 64:])
    assert frames_of_part == frames
    assert renderer.lighting_statistics["samples_per_pixel"] == 64
    # Less of it is there already.
    renderer.area = (96, 0, 32, 96)
    assert completed(renderer, scene, camera)[1] == 1
    # More of it takes as many frames again, which leave the rest alone.
    renderer.area = (20, 0, 108, 96)
    more, frames_of_more = completed(renderer, scene, camera)
    assert frames_of_more == frames
    np.testing.assert_array_equal(more[:, 64:], whole[:, 64:])
    # Batches of other random numbers.
    difference = abs(more[:, 20:64].astype(int) - whole[:, 20:64])
    assert difference.any()
    assert difference.mean() < 1.0
    assert (difference.max(axis=2) > 8).mean() < 0.1


def test_an_area_that_grows_within_a_batch_begins_it_again(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera
) -> None:
    size = (96, 64)
    settings = RenderSettings(ibl="reference", reference_samples=64)
    renderer = Renderer(egl_device, size, settings)
    whole, frames = completed(renderer, scene, camera)
    renderer = Renderer(egl_device, size, settings)
    renderer.area = (32, 0, 64, 64)
    shown(renderer, scene, camera)
    renderer.area = None
    found, frames_of_it = completed(renderer, scene, camera)
    assert frames_of_it == frames
    np.testing.assert_array_equal(found, whole)


def test_samples_at_centres_have_the_edges_of_a_mode_without_samples(
    egl_device: GraphicsDevice, scene: Scene, camera: Camera
) -> None:
    """An emissive scene has no other difference."""
    scene.environment = None
    scene.background = (1.0, 1.0, 1.0)
    plain = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    truth = Renderer(
        egl_device,
        SIZE,
        RenderSettings(ibl="reference", reference_samples=32),
        beside=plain,
    )
    truth.at_centres = True
    expected = shown(plain, scene, camera)
    found = shown(truth, scene, camera)
    while not truth.is_complete:
        found = shown(truth, scene, camera)
    np.testing.assert_array_equal(found, expected)
    assert len(np.unique(expected)) == 2
    plain.close()
