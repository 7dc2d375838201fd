"""The maps of an environment are drawn when something is to read them."""

from collections.abc import Iterator

import pytest

from moka.backend.recording_backend import RecordingBackend
from moka.commands.handles import ResourceKind
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment import load_environment
from moka.lighting.environment_lighting import LightingRequest
from moka.lighting.environment_maps import EnvironmentMaps
from moka.lighting.make_lighting import make_lighting

KINDS = (
    ResourceKind.TEXTURE,
    ResourceKind.FRAMEBUFFER,
    ResourceKind.BIND_GROUP,
    ResourceKind.BUFFER,
)


@pytest.fixture
def backend() -> RecordingBackend:
    return RecordingBackend()


@pytest.fixture
def device(backend: RecordingBackend) -> Iterator[GraphicsDevice]:
    with GraphicsDevice(lambda: backend) as opened:
        yield opened


def make(device: GraphicsDevice) -> EnvironmentMaps:
    request = LightingRequest(load_environment("sky"), 1, specular=True)
    return make_lighting(device, FullscreenPasses(device), request).maps


def test_they_are_drawn_once_after_their_programs_are_there(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    maps = make(device)
    device.finish()
    assert device.count(ResourceKind.PROGRAM) > 2
    assert not backend.frames
    for _ in range(2):
        maps.fill()
        device.finish()
        assert backend.stages == ["environment"]


@pytest.mark.parametrize("is_filled", [True, False])
def test_what_is_destroyed_leaves_nothing(
    device: GraphicsDevice, is_filled: bool
) -> None:
    maps = make(device)
    if is_filled:
        maps.fill()
    maps.destroy(device)
    assert [device.count(kind) for kind in KINDS] == [0, 0, 0, 0]
