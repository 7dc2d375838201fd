"""Where the time of frames goes."""

from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.graphics.device import GraphicsDevice
from moka.ui.frame_times import FRAMES, FrameTimes, History, mark_passes


def test_a_history_remembers_the_last_frames() -> None:
    history = History()
    for number in range(FRAMES + 10):
        history.put({"scene": float(number), "once": float(number == 0)})
    assert list(history.series) == ["scene"]  # The other one is forgotten.
    assert history.series["scene"][0] == 10
    assert history.series["scene"][-1] == FRAMES + 9
    assert history.mean("scene", 2) == FRAMES + 8.5
    history.put({"panels": 2.0})
    assert history.total[-1] == 2.0
    assert history.total[-2] == FRAMES + 9


def test_stages_of_a_frame_add_up() -> None:
    times = FrameTimes()
    times.add("scene", 0.25)
    times.add("scene", 0.25)
    with times.stage("panels"):
        pass
    assert not times.cpu.series  # The frame is not over.
    assert times.begin_frame() == []
    assert times.cpu.series["scene"][-1] == 500.0
    assert 0.0 < times.cpu.series["panels"][-1] < 500.0


def test_the_gpu_is_asked_only_when_somebody_looks() -> None:
    """Times of both lists of a frame arrive together, frames later."""
    with GraphicsDevice(RecordingBackend) as device:
        times = FrameTimes()
        assert times.begin_frame() == []
        times.wants_gpu = True
        main, other = times.begin_frame()
        for place, prefix in ((other, "beside: "), (main, "")):
            commands = CommandList()
            mark_passes(commands, place, prefix)
            device.submit(commands).wait()
        assert main.marks is not None
        assert other.marks is not None
        # A millisecond a pass.
        main.marks = [
            (name, 1_000_000 * number)
            for number, (name, _) in enumerate(main.marks)
        ]
        other.marks = [
            (name, 2_000_000 * number)
            for number, (name, _) in enumerate(other.marks)
        ]
        assert times.begin_frame() == []
        assert times.gpu.series["scene"][-1] == 1.0
        assert times.gpu.series["panels"][-1] == 1.0
        assert times.gpu.series["beside: scene"][-1] == 2.0
        assert "end" not in times.gpu.series


def test_a_gpu_that_never_tells_is_not_waited_for() -> None:
    times = FrameTimes()
    for _ in range(100):
        times.wants_gpu = True
        assert len(times.begin_frame()) == 2
    assert not times.gpu.series
