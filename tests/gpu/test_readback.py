"""Pixels that arrive while later frames are drawn are those of their frame."""

from collections.abc import Iterator

import numpy as np
import pytest

from moka.backend.contexts import open_context
from moka.backend.moderngl_backend import ModernGLBackend
from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.descriptors import (
    Attachment,
    FramebufferDescriptor,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.core.errors import DeviceError
from moka.graphics.device import Frame, GraphicsDevice
from moka.graphics.shader_source import explain_log

pytestmark = pytest.mark.gpu


@pytest.fixture(params=[False, True])
def reading(request: pytest.FixtureRequest) -> Iterator[GraphicsDevice]:
    """A device that reads at once, and one that reads through buffers."""

    def open_backend() -> ModernGLBackend:
        return ModernGLBackend(
            open_context("egl", debug=True),
            explain_log,
            asynchronous=request.param,
        )

    with GraphicsDevice(open_backend) as device:
        yield device
        device.finish()


def canvas(device: GraphicsDevice, side: int) -> Handle:
    texture = device.create_texture(
        TextureDescriptor(PixelFormat.RGBA8, side, side)
    )
    return device.create_framebuffer(
        FramebufferDescriptor((Attachment(texture),))
    )


def submit(
    device: GraphicsDevice, target: Handle, grey: float, side: int = 16
) -> tuple[Frame, Readback]:
    """A frame of one grey, read as bytes."""
    commands = CommandList()
    commands.bind_framebuffer(target)
    commands.clear((grey, grey, grey, 1.0))
    read = commands.read_pixels(target, (0, 0, side, side), dtype="u1")
    return device.submit(commands), read


def test_each_frame_keeps_its_own(reading: GraphicsDevice) -> None:
    """Buffers are used again, and the frame that waits is not the last."""
    target = canvas(reading, 16)
    pending = [submit(reading, target, grey / 255.0) for grey in range(40)]
    for grey, (frame, read) in enumerate(pending):
        frame.wait()
        assert frame.is_done
        assert read.data is not None
        assert read.data.shape == (16, 16, 4)
        assert (read.data[..., :3] == grey).all()


def test_the_next_frame_brings_the_one_before(reading: GraphicsDevice) -> None:
    target = canvas(reading, 16)
    _, first = submit(reading, target, 1.0)
    second, _ = submit(reading, target, 0.0)
    second.wait_for_execution()
    assert first.data is not None
    assert (first.data == 255).all()


def test_a_frame_that_nobody_waits_for_arrives(reading: GraphicsDevice) -> None:
    frame, read = submit(reading, canvas(reading, 16), 1.0)
    assert frame.is_done_within(60.0)
    assert read.data is not None


def test_sizes_and_formats_may_change(reading: GraphicsDevice) -> None:
    small, large = canvas(reading, 4), canvas(reading, 64)
    for side, target in ((4, small), (64, large), (4, small)):
        frame, read = submit(reading, target, 0.2, side)
        frame.wait()
        assert read.data is not None
        assert (read.data[..., :3] == 51).all()
    commands = CommandList()
    floats = commands.read_pixels(small, (1, 1, 2, 3), channels=2)
    reading.submit(commands)
    reading.finish()
    assert floats.data is not None
    assert floats.data.dtype == np.float32
    assert floats.data.shape == (3, 2, 2)
    assert np.allclose(floats.data, 0.2, atol=1e-6)


def test_a_device_that_closes_leaves_nobody_waiting() -> None:
    def open_backend() -> ModernGLBackend:
        backend = ModernGLBackend(
            open_context("egl"), explain_log, asynchronous=True
        )
        # A GPU that is never done.
        backend._reader.take = lambda *_, **__: True  # type: ignore[method-assign]
        return backend

    device = GraphicsDevice(open_backend)
    _, read = submit(device, canvas(device, 16), 1.0)
    device.close()
    assert read.arrived.done()
    with pytest.raises(DeviceError, match="closed"):
        read.arrived.result()
