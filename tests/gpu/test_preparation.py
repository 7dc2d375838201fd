"""What is prepared on another thread is drawn as if it had been made here."""

import threading
from collections.abc import Callable
from typing import TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.backend import moderngl_backend
from moka.commands.command_list import CommandList
from moka.commands.handles import ResourceKind
from moka.graphics.device import GraphicsDevice
from moka.lighting import preintegration_passes
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model import model_of, sphere
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene

pytestmark = pytest.mark.gpu

SIZE = (40, 32)
Result = TypeVar("Result")


def uneven(seed: int) -> Environment:
    """Random radiance with a sun, of 64 texels along a cube's edge."""
    pixels = np.random.default_rng(seed).random((128, 256, 3), np.float32)
    pixels[30, 100] = 4000.0
    return Environment(pixels)


def ball_scene(environment: Environment) -> tuple[Scene, Camera]:
    scene, camera = Scene(), Camera()
    material = Material(metallic_factor=0.5, roughness_factor=0.4)
    scene.add(model_of([(sphere(), material, np.eye(4))]))
    scene.environment = environment
    camera.frame(scene.bounds(), SIZE[0] / SIZE[1])
    return scene, camera


def drawn(
    renderer: Renderer, scene: Scene, camera: Camera
) -> NDArray[np.float32]:
    commands = CommandList()
    renderer.draw(scene, camera, commands)
    read = renderer.read_radiance(commands)
    renderer.device.submit(commands).wait()
    assert read.data is not None
    pixels: NDArray[np.float32] = read.data
    return pixels


def elsewhere(job: Callable[[], Result]) -> Result:
    """What ``job`` returns on another thread."""
    results: list[Result] = []
    thread = threading.Thread(target=lambda: results.append(job()))
    thread.start()
    thread.join(60)
    return results[0]


def nobody(*_: object) -> None:
    """Is told, and does nothing."""


@pytest.mark.parametrize("ibl", ["split-sum", "filtered", "reference"])
def test_lighting_in_pieces_is_lighting(
    egl_device: GraphicsDevice, ibl: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Bands of a few rows, as large environments have them.
    monkeypatch.setattr(preintegration_passes, "_READS_OF_A_PIECE", 20_000)
    settings = RenderSettings(
        samples=1, ibl=ibl, irradiance="cube", reference_samples=4
    )
    scene, camera = ball_scene(uneven(1))
    expected = drawn(Renderer(egl_device, SIZE, settings), scene, camera)

    renderer = Renderer(egl_device, SIZE, settings)
    told: list[tuple[int, int]] = []
    made = elsewhere(
        lambda: renderer.prepare_lighting(
            scene.environment,
            scene,
            settings,
            lambda *now: told.append(now),
        )
    )
    assert made is not None
    renderer.adopt_lighting(made)
    assert np.array_equal(drawn(renderer, scene, camera), expected)
    # It is there now.
    again = renderer.prepare_lighting(
        scene.environment, scene, settings, nobody
    )
    assert again is None
    if ibl != "reference":  # Which samples the map, and integrates nothing.
        assert len(told) > 20
        assert [done for done, _ in told] == list(range(1, len(told) + 1))
        assert {total for _, total in told} == {len(told)}


def test_pictures_are_drawn_between_the_pieces(
    egl_device: GraphicsDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preintegration_passes, "_READS_OF_A_PIECE", 20_000)
    scene, camera = ball_scene(uneven(1))
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    before = drawn(renderer, scene, camera)
    following = uneven(2)
    waits, draws = threading.Event(), threading.Event()

    def told(done: int, total: int) -> None:
        if done == total // 2:
            waits.set()
            assert draws.wait(60)

    def draw_meanwhile() -> None:
        assert waits.wait(60)
        assert np.array_equal(drawn(renderer, scene, camera), before)
        draws.set()

    thread = threading.Thread(target=draw_meanwhile)
    thread.start()
    made = renderer.prepare_lighting(following, scene, renderer.settings, told)
    assert made is not None
    thread.join(60)
    assert draws.is_set()
    scene.environment = following
    renderer.adopt_lighting(made)
    fresh = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    assert np.array_equal(
        drawn(renderer, scene, camera), drawn(fresh, scene, camera)
    )


def test_what_is_prepared_is_not_made_again_and_nothing_is_left(
    egl_device: GraphicsDevice,
) -> None:
    scene, camera = ball_scene(uneven(1))
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    drawn(renderer, scene, camera)
    kinds = list(ResourceKind)
    before = [egl_device.count(kind) for kind in kinds]
    scene.environment = uneven(2)
    made = renderer.prepare_lighting(
        scene.environment, scene, renderer.settings, nobody
    )
    assert made is not None
    assert egl_device.count(ResourceKind.TEXTURE) > before[1]
    spent = renderer.statistics.stages_ms["environment"]
    renderer.adopt_lighting(made)
    drawn(renderer, scene, camera)
    assert renderer.statistics.stages_ms["environment"] == spent
    assert [egl_device.count(kind) for kind in kinds] == before


def test_what_is_prepared_and_not_wanted_goes(
    egl_device: GraphicsDevice,
) -> None:
    scene, camera = ball_scene(uneven(1))
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    drawn(renderer, scene, camera)
    textures = egl_device.count(ResourceKind.TEXTURE)
    for seed in (2, 3):
        made = renderer.prepare_lighting(
            uneven(seed), scene, renderer.settings, nobody
        )
        assert made is not None
        renderer.adopt_lighting(made)
    scene.environment = uneven(4)
    drawn(renderer, scene, camera)
    assert egl_device.count(ResourceKind.TEXTURE) == textures


def test_geometry_that_is_prepared_is_not_uploaded_again(
    egl_device: GraphicsDevice,
) -> None:
    scene, camera = ball_scene(uneven(1))
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    expected = drawn(renderer, scene, camera)
    following = model_of(
        [
            (
                sphere(),
                Material(metallic_factor=0.5, roughness_factor=0.4),
                np.eye(4),
            )
        ]
    )
    layout = scene.layout_of(following, 0, None)
    told: list[tuple[str, int, int]] = []
    uploads = elsewhere(
        lambda: renderer.prepare_geometry(
            layout.primitives, lambda *now: told.append(now)
        )
    )
    assert told == [("meshes", 0, 1)]
    meshes = egl_device.count(ResourceKind.MESH)
    scene.models[0].remove()
    renderer.adopt_geometry(uploads)
    scene.add(following)
    assert np.array_equal(drawn(renderer, scene, camera), expected)
    # Those of the first one have gone.
    assert egl_device.count(ResourceKind.MESH) == meshes - 1


def test_geometry_that_somebody_else_made_first_is_let_go(
    egl_device: GraphicsDevice,
) -> None:
    scene, camera = ball_scene(uneven(1))
    renderer = Renderer(egl_device, SIZE, RenderSettings(samples=1))
    layout = scene.models[0].layout
    uploads = renderer.prepare_geometry(layout.primitives, nobody)
    expected = drawn(renderer, scene, camera)
    meshes = egl_device.count(ResourceKind.MESH)
    renderer.adopt_geometry(uploads)
    assert egl_device.count(ResourceKind.MESH) == meshes - 1
    assert np.array_equal(drawn(renderer, scene, camera), expected)


def test_large_buffers_are_filled_as_small_ones_are(
    egl_device: GraphicsDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, camera = ball_scene(uneven(1))
    settings = RenderSettings(samples=1)
    expected = drawn(Renderer(egl_device, SIZE, settings), scene, camera)
    monkeypatch.setattr(moderngl_backend, "_LARGE_UPLOAD", 1)
    renderer = Renderer(egl_device, SIZE, settings)
    assert np.array_equal(drawn(renderer, scene, camera), expected)
