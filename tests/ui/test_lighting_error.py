"""The error of the lighting for what is seen."""

import time

import numpy as np
import pytest

from moka.core.errors import MokaError
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.lighting.lighting_maker import LightingMaker
from moka.model import demo_model
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from moka.ui.lighting_error import ErrorMeasurement, lighting_error


def test_errors_are_those_of_their_definition() -> None:
    objects = np.zeros((8, 8), np.uint32)
    objects[:4, :4] = 3
    objects[4:, 4:] = 5
    truth = np.full((8, 8, 4), 2.0)
    truth[4:, 4:] = 0.5
    picture = truth.copy()
    picture[0, 0, 0] += 4.8  # One hot channel of 48.
    picture[4:, 4:] *= 1.1
    picture[objects == 0] = 1e9  # Behind everything.
    found = lighting_error(truth, picture, objects)
    assert found is not None
    first = np.sqrt(4.8**2 / 48) / 2.0
    assert found.relative_rmse == pytest.approx((first + 0.1) / 2)
    assert found.median == pytest.approx(0.05, abs=0.051)
    assert found.pixels == 32


def test_nothing_to_see_has_no_error() -> None:
    black = np.zeros((8, 8, 4))
    assert lighting_error(black, black, np.zeros((8, 8), np.uint32)) is None
    assert lighting_error(black, black, np.ones((8, 8), np.uint32)) is None


@pytest.fixture
def scene() -> Scene:
    made = Scene()
    made.add(demo_model())
    made.environment = load_environment("studio")
    return made


def measured(renderer: Renderer, scene: Scene) -> ErrorMeasurement:
    camera = Camera()
    camera.frame(scene.bounds(), 1.5, 0.4, 0.2)
    measurement = ErrorMeasurement(renderer, scene, camera, 16)
    while not measurement.is_done:
        measurement.step()
        time.sleep(0.002)
    return measurement


@pytest.mark.gpu
def test_a_better_mode_has_a_smaller_error(scene: Scene) -> None:
    """And the renderer that it stands beside goes on as before."""
    with GraphicsDevice.open("egl", debug=True) as device:
        renderer = Renderer(device, (60, 40), RenderSettings(suns="off"))
        errors = {}
        for brdf in ("gltf", "blinn-phong"):
            renderer.settings = RenderSettings(brdf=brdf)
            found = measured(renderer, scene).result
            assert found is not None
            errors[brdf] = found
        # The reference has the same BRDF, so that split-sum alone differs.
        for found in errors.values():
            assert 0.0 < found.median < 0.3
            assert found.truth_error is not None
        assert renderer.size == (60, 40)
        renderer.close()


@pytest.mark.gpu
def test_what_moves_cannot_be_measured(scene: Scene) -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        renderer = Renderer(device, (30, 20), RenderSettings())
        camera = Camera()
        camera.frame(scene.bounds(), 1.5)
        measurement = ErrorMeasurement(renderer, scene, camera, 16)

        def measure() -> None:
            while not measurement.is_done:
                scene.environment_rotation += 0.01
                measurement.step()
                time.sleep(0.002)

        with pytest.raises(MokaError, match="while the scene moves"):
            measure()
        renderer.close()


@pytest.mark.gpu
def test_light_that_was_prepared_gives_the_same_and_is_not_made_again(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    with GraphicsDevice.open("egl", debug=True) as device:
        renderer = Renderer(device, (60, 40), RenderSettings(suns="off"))
        expected = measured(renderer, scene).result
        camera = Camera()
        camera.frame(scene.bounds(), 1.5, 0.4, 0.2)
        measurement = ErrorMeasurement(renderer, scene, camera, 16)
        measurement.waits = True
        measurement.step()
        assert measurement.progress == 0.0
        told: list[tuple[int, int]] = []
        measurement.prepare(lambda *now: told.append(now))
        assert told
        measurement.waits = False
        monkeypatch.setattr(LightingMaker, "make", None)
        while not measurement.is_done:
            measurement.step()
            time.sleep(0.002)
        assert measurement.result == expected
        renderer.close()
