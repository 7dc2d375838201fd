"""How many samples a picture's targets have."""

from collections.abc import Iterator

import numpy as np
import pytest

from moka.backend.protocol import BackendInfo
from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.descriptors import TextureDescriptor
from moka.graphics.device import GraphicsDevice
from moka.model import cube
from moka.model.assemble import model_of
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene

INFO = BackendInfo(kind="recording", max_samples=4, clip_control=True)


def texture_samples(backend: RecordingBackend) -> Iterator[int]:
    for resource in backend.resources.values():
        if isinstance(resource, TextureDescriptor):
            yield resource.samples


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
            assert max(texture_samples(backend)) == expected
            scene.add(model_of([(cube(), None, np.eye(4))]))
        renderer.close()
