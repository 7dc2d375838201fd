"""The device over a backend on paper: handles, frames, packets."""

import threading
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    ShaderText,
    TextureDescriptor,
    Topology,
)
from moka.commands.handles import Handle, ResourceKind
from moka.commands.recording import DrawSpan
from moka.commands.sort_key import SortKey, Stage
from moka.core.errors import CommandError, DeviceError, ShaderError
from moka.graphics.device import Frame, GraphicsDevice


@pytest.fixture
def backend() -> RecordingBackend:
    return RecordingBackend()


@pytest.fixture
def device(backend: RecordingBackend) -> Iterator[GraphicsDevice]:
    with GraphicsDevice(lambda: backend) as device:
        yield device


def make_draw(device: GraphicsDevice) -> tuple[Handle, Handle, Handle]:
    """A program, a mesh and a bind group that draw something."""
    return (
        device.create_program(
            ProgramDescriptor(ShaderText("v"), ShaderText("f"))
        ),
        device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3)),
        device.create_bind_group(BindGroupDescriptor()),
    )


def test_a_frame_reaches_the_backend_sorted(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    program, mesh, group = make_draw(device)
    commands = CommandList()
    commands.draw(program, mesh, group, key=SortKey(1, stage=Stage.OPAQUE))
    commands.clear((0, 0, 0, 1), key=SortKey(1))
    counters = device.submit(commands).wait()
    assert counters.draw_packets == 1
    (recording,) = backend.frames
    assert type(recording.steps[0]).__name__ == "Clear"
    assert recording.steps[1] == DrawSpan(0, 1)
    assert recording.draws["program"][0] == program.index


def test_equal_draws_merge_on_paper_as_on_the_gpu(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    program, mesh, group = make_draw(device)
    commands = CommandList()
    for _ in range(5):
        commands.draw(program, mesh, group)
    assert device.submit(commands).wait().gl_draws == 5
    # Each stands in a command buffer of its own, hence five spans; in one
    # buffer they are still separate packets of one span each.
    assert len(backend.frames[0].draws) == 5


def test_a_destroyed_resource_cannot_be_submitted(
    device: GraphicsDevice,
) -> None:
    program, mesh, group = make_draw(device)
    device.destroy(mesh)
    commands = CommandList()
    commands.draw(program, mesh, group)
    with pytest.raises(CommandError, match="used after it was destroyed"):
        device.submit(commands)


def test_another_devices_resource_cannot_be_submitted(
    device: GraphicsDevice,
) -> None:
    program, mesh, group = make_draw(device)
    commands = CommandList()
    commands.draw(program, mesh, group)
    with (
        GraphicsDevice(RecordingBackend) as other,
        pytest.raises(CommandError, match="belongs to device"),
    ):
        other.submit(commands)


def test_destruction_waits_for_the_frames_before_it(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    program, mesh, group = make_draw(device)
    gate = threading.Event()
    execute = backend.execute
    alive = []

    def slow(*arguments: object) -> object:
        gate.wait(5)
        alive.append(mesh in backend.resources)
        return execute(*arguments)

    backend.execute = slow
    commands = CommandList()
    commands.draw(program, mesh, group)
    frame = device.submit(commands)
    device.destroy(mesh)
    gate.set()
    frame.wait()
    device.finish()
    assert alive == [True]
    assert mesh not in backend.resources


def test_at_most_one_frame_is_in_flight(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    running = []
    execute = backend.execute

    def watch(*arguments: object) -> object:
        running.append(sum(not frame.is_done for frame in frames))
        return execute(*arguments)

    backend.execute = watch
    frames: list[Frame] = []
    frames.extend(device.submit(CommandList()) for _ in range(10))
    frames[-1].wait()
    assert max(running) <= 2


def test_making_things_of_dead_or_wrong_handles_is_an_error(
    device: GraphicsDevice,
) -> None:
    texture = device.create_texture(TextureDescriptor(PixelFormat.RGBA8, 4, 4))
    buffer = device.create_buffer(BufferDescriptor(BufferUsage.VERTEX, 16))
    with pytest.raises(CommandError, match="expected a texture handle"):
        device.create_framebuffer(FramebufferDescriptor((Attachment(buffer),)))
    device.destroy(texture)
    with pytest.raises(CommandError, match="destroyed"):
        device.create_framebuffer(FramebufferDescriptor((Attachment(texture),)))
    with pytest.raises(CommandError, match="destroyed"):
        device.destroy(texture)


def test_a_shader_error_that_is_waited_for_leaves_the_device_usable(
    device: GraphicsDevice, backend: RecordingBackend
) -> None:
    def refuse(*_: object) -> None:
        raise ShaderError("surface.frag:3: nonsense")

    backend.create_program = refuse
    descriptor = ProgramDescriptor(ShaderText("v"), ShaderText("f"))
    with pytest.raises(ShaderError, match=r"surface\.frag:3"):
        device.create_program(descriptor, wait=True)
    device.finish()
    assert device.count(ResourceKind.PROGRAM) == 0


class Driver(RecordingBackend):
    """Says of what is called broken, once it is asked, that it is."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[str] = []
        self._begun: dict[Handle, str] = {}

    def create_program(self, handle, descriptor):  # type: ignore[no-untyped-def]
        super().create_program(handle, descriptor)
        self._begun[handle] = descriptor.label
        self.heard.append(f"begin {descriptor.label}")

    def finish_programs(self, handles=None):  # type: ignore[no-untyped-def]
        for handle in tuple(self._begun) if handles is None else handles:
            label = self._begun.pop(handle)
            self.heard.append(f"finish {label}")
            if label == "broken":
                raise ShaderError("surface.frag:3: nonsense")

    def execute(self, recording, stage="frame"):  # type: ignore[no-untyped-def]
        self.finish_programs()
        return super().execute(recording, stage)


def labelled(label: str) -> ProgramDescriptor:
    return ProgramDescriptor(ShaderText("v"), ShaderText("f"), label)


def test_programs_begin_one_after_the_other_and_then_are_waited_for() -> None:
    driver = Driver()
    with GraphicsDevice(lambda: driver) as device:
        device.create_program(labelled("early"))
        device.create_programs([labelled("a"), labelled("b")])
        assert device.create_programs([]) == []
    assert driver.heard == [
        *("begin early", "finish early"),
        *("begin a", "begin b", "finish a", "finish b"),
    ]


def test_of_several_programs_there_are_all_or_none() -> None:
    driver = Driver()
    with GraphicsDevice(lambda: driver) as device:
        labels = ("a", "broken", "c")
        with pytest.raises(ShaderError, match=r"surface\.frag:3"):
            device.create_programs([labelled(label) for label in labels])
        device.finish()
        assert not driver.resources
        assert device.count(ResourceKind.PROGRAM) == 0


@pytest.mark.parametrize(
    "call",
    [
        GraphicsDevice.finish,
        GraphicsDevice.stage_seconds,
        lambda device: device.submit(CommandList()).wait(),
        lambda device: device.create_program(labelled("late"), wait=True),
    ],
)
def test_a_program_that_is_not_waited_for_fails_at_the_next_call(
    call: Callable[[GraphicsDevice], object],
) -> None:
    with GraphicsDevice(Driver) as device:
        device.create_program(labelled("broken"))
        with pytest.raises(ShaderError, match=r"surface\.frag:3"):
            call(device)
        # The device is closed for work.
        with pytest.raises(ShaderError):
            device.finish()


def test_read_backs_are_filled(device: GraphicsDevice) -> None:
    commands = CommandList()
    readback = commands.read_pixels(None, (0, 0, 3, 2), dtype="u1")
    assert readback.data is None
    device.submit(commands).wait()
    assert readback.data is not None
    assert readback.data.shape == (2, 3, 4)
    assert readback.data.dtype == np.uint8


def test_a_closed_device_refuses_work() -> None:
    device = GraphicsDevice(RecordingBackend)
    device.close()
    device.close()
    assert device.is_closed
    with pytest.raises(DeviceError, match="closed"):
        device.submit(CommandList())
