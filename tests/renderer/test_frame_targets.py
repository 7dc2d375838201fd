"""How many samples a picture's targets have, and when they are made."""

import time

import numpy as np
import pytest

from moka.backend.protocol import BackendInfo
from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.commands import Clear
from moka.commands.descriptors import TextureDescriptor
from moka.core.encoded_image import EncodedImage
from moka.core.png import encode_png
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material, Texture
from moka.model import cube
from moka.model.assemble import model_of
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene

INFO = BackendInfo(
    kind="recording", max_samples=4, max_integer_samples=4, clip_control=True
)


def textures(backend: RecordingBackend) -> list[TextureDescriptor]:
    return [
        each
        for each in tuple(backend.resources.values())
        if isinstance(each, TextureDescriptor)
    ]


@pytest.mark.parametrize("samples", [1, 4, 16])
def test_edges_have_as_many_samples_as_asked_for(samples: int) -> None:
    """And a sky without any model has one, until there is a model."""
    backend = RecordingBackend(INFO)
    scene = Scene()
    with GraphicsDevice(lambda: backend) as device:
        renderer = Renderer(device, (8, 8), RenderSettings(samples=samples))
        for expected in (1, min(samples, 4)):
            commands = CommandList()
            renderer.draw(scene, Camera(), commands)
            device.submit(commands).wait()
            counts = {each.samples for each in textures(backend)}
            assert max(counts) == expected
            assert renderer.statistics.counts["samples"] == expected
            scene.add(model_of([(cube(), None, np.eye(4))]))
        renderer.close()


class SlowImage(EncodedImage):
    """Says, when it has been read, how large textures were by then."""

    def __init__(self, backend: RecordingBackend, data: bytes) -> None:
        super().__init__("slow", data=data)
        self.widths: set[int] = set()
        self._backend = backend

    def read(self) -> bytes | memoryview:
        time.sleep(0.2)
        self.widths = {each.width for each in textures(self._backend)}
        return super().read()


@pytest.mark.parametrize("shading", ["forward", "visibility"])
def test_targets_are_made_when_images_are_decoded(shading: str) -> None:
    """They get the memory that was needed for that."""
    backend = RecordingBackend(INFO)
    image = SlowImage(backend, encode_png(np.zeros((2, 2, 3), np.uint8)))
    material = Material(base_colour_texture=Texture(image))
    scene = Scene()
    scene.add(model_of([(cube(), material, np.eye(4))]))
    with GraphicsDevice(lambda: backend) as device:
        renderer = Renderer(device, (300, 200), RenderSettings(shading=shading))
        commands = CommandList()
        renderer.draw(scene, Camera(), commands)
        renderer.read_display(commands)
        device.submit(commands).wait()
        assert 300 not in image.widths
        made = [each for each in textures(backend) if each.width == 300]
        assert made
        labels = {each.label for each in made}
        assert ("visibility" in labels) == (shading == "visibility")
        renderer.close()


@pytest.mark.parametrize("samples", [1, 4])
def test_frames_after_the_first_draw_the_sky_apart(samples: int) -> None:
    """And clear nothing for it: one picture would compile more than it gains.

    The depth of what is seen tells where the sky is.
    """
    backend = RecordingBackend(INFO)
    scene = Scene()
    scene.environment = Environment(np.ones((2, 4, 3), np.float32))
    scene.add(model_of([(cube(), None, np.eye(4))]))
    camera = Camera()
    camera.transform.translate((0, 0, 3))
    draws, clears = [], []
    with GraphicsDevice(lambda: backend) as device:
        settings = RenderSettings(samples=samples, shading="visibility")
        renderer = Renderer(device, (8, 8), settings)
        for _ in range(3):
            commands = CommandList()
            renderer.draw(scene, camera, commands)
            draws.append(device.submit(commands).wait().gl_draws)
            steps = backend.frames[-1].steps
            clears.append(sum(isinstance(each, Clear) for each in steps))
        renderer.close()
    assert draws == [draws[0], draws[0] + 1, draws[0] + 1]
    assert clears == [clears[0], clears[0] - 1, clears[0] - 1]
