"""The GPU's clock, read between commands."""

import pytest

from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.commands import Timestamps
from moka.commands.descriptors import CullMode, RasterState
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from tests.support.drawing import Canvas, nothing_bound, number_program, square

pytestmark = pytest.mark.gpu

FLAT = RasterState(cull=CullMode.NONE, depth_test=None, depth_write=False)


def submit(device: GraphicsDevice, canvas: Canvas, draws: int) -> Timestamps:
    """A frame of ``draws`` squares between two marks, then of none."""
    times = Timestamps()
    commands = CommandList()
    commands.timestamp("draws", times, key=SortKey(1))
    commands.bind_framebuffer(canvas.framebuffer, key=SortKey(1))
    program, mesh = number_program(device), square(device)
    group = nothing_bound(device)
    buffer = commands.command_buffer(SortKey(1))
    for _ in range(draws):
        buffer.draw(program, mesh, group, FLAT)
    commands.timestamp("nothing", times, key=SortKey(2))
    commands.timestamp("end", times, key=SortKey(3))
    device.submit(commands).wait()
    return times


def test_times_arrive_later_and_grow_with_the_work(
    device: GraphicsDevice,
) -> None:
    canvas = Canvas(device, (256, 256))
    submit(device, canvas, 1)  # Compiles.
    device.finish()
    few = submit(device, canvas, 1)
    many = submit(device, canvas, 500)
    device.finish()
    submit(device, canvas, 1)
    assert few.seconds is not None
    assert many.seconds is not None
    assert list(many.seconds) == ["draws", "nothing"]
    assert many.seconds["draws"] > few.seconds["draws"] > 0.0
    assert many.seconds["draws"] > many.seconds["nothing"] >= 0.0


def test_queries_are_used_again(device: GraphicsDevice) -> None:
    """Also two recordings' times at once are each one's own."""
    first, second = Timestamps(), Timestamps()
    for _ in range(50):
        commands = CommandList()
        for label in ("a", "b"):
            commands.timestamp(label, first, key=SortKey(1))
            commands.timestamp(label, second, key=SortKey(1))
        device.submit(commands).wait()
        device.finish()
    for times in (first, second):
        assert times.marks is not None
        assert [label for label, _ in times.marks] == ["a", "b"]


def test_a_recording_backend_says_that_nothing_took_any_time() -> None:
    with GraphicsDevice(RecordingBackend) as device:
        times = Timestamps()
        assert times.seconds is None
        commands = CommandList()
        for label in ("scene", "display", "scene", "end"):
            commands.timestamp(label, times)
        device.submit(commands).wait()
        assert times.seconds == {"scene": 0.0, "display": 0.0}
