"""The loop in a window: when it draws, and when it lets things be."""

import threading
from collections.abc import Iterator

import numpy as np
import pytest

import moka
from moka.app.application import GameTime
from moka.commands.command_list import CommandList
from moka.material.material import Material
from moka.model import cube, model_of
from tests.support.animated import AnimatedFile
from tests.support.display import running_display

pytestmark = [pytest.mark.window, pytest.mark.gpu]

SIZE = (64, 48)


@pytest.fixture(scope="module", autouse=True)
def display() -> Iterator[str]:
    glfw = pytest.importorskip("glfw")
    with running_display() as name:
        yield name
        glfw.terminate()


class Counting(moka.App):
    """Notes its updates and frames."""

    def __init__(self) -> None:
        super().__init__()
        self.updates: list[GameTime] = []
        self.frames: list[GameTime] = []

    def load(self) -> None:
        self.scene.add(model_of([(cube(1.0), Material(), np.eye(4))]))

    def update(self, time: GameTime) -> None:
        self.updates.append(time)

    def draw(self, time: GameTime, commands: CommandList) -> None:
        self.frames.append(time)
        super().draw(time, commands)


def run(app: Counting, frames: int | None = 4) -> Counting:
    moka.run(app, frames=frames, size=SIZE, vsync=False, cache=False)
    return app


def test_frames_follow_one_another_by_default() -> None:
    app = run(Counting())
    assert app.updates == app.frames
    assert [time.frame for time in app.frames] == [0, 1, 2, 3]
    assert app.frames[0].delta == 0


def test_an_app_that_waits_draws_what_it_is_asked_for() -> None:
    class Waiting(Counting):
        continuous = False

        def draw(self, time: GameTime, commands: CommandList) -> None:
            super().draw(time, commands)
            if time.frame == 0:
                self.asking = threading.Timer(0.5, self.request_redraw)
                self.ending = threading.Timer(1.0, self.end)
                self.asking.start()
                self.ending.start()

        def end(self) -> None:
            self.quit()
            self.request_redraw()

        def close(self) -> None:
            self.asking.join()
            self.ending.join()

    app = run(Waiting(), frames=None)
    # The first, those after events of the window itself, and the one.
    assert 2 <= len(app.frames) <= 8


def test_an_app_that_waits_draws_while_an_animation_plays() -> None:
    file = AnimatedFile()
    ends = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]
    file.channel((0, "translation"), [0, 1], ends)

    class Playing(Counting):
        continuous = False

        def load(self) -> None:
            model = self.scene.add(moka.load_model(file.glb()))
            model.animations.play()
            # Or a loop that waits for nothing would never end.
            self.ending = threading.Timer(20, self.quit)
            self.ending.start()

        def close(self) -> None:
            self.ending.cancel()

    app = run(Playing(), frames=12)
    assert len(app.frames) == 12


def test_a_limit_of_frames_is_kept() -> None:
    class Limited(Counting):
        frame_limit = 10.0

    app = run(Limited())
    assert all(time.delta >= 0.0999 for time in app.frames[1:])


def test_fixed_steps_are_of_one_length() -> None:
    class Fixed(Counting):
        fixed_step = 0.001

    app = run(Fixed())
    assert {time.delta for time in app.updates} == {0.001}
    steps = [time.frame for time in app.updates]
    assert steps == list(range(len(steps)))
    assert len(app.frames) == 4


def test_nothing_is_updated_in_a_pause() -> None:
    class Paused(Counting):
        paused = True

    app = run(Paused())
    assert app.updates == []
    assert {time.total for time in app.frames} == {0.0}


def test_an_error_ends_the_loop_and_closes_the_window() -> None:
    class Failing(Counting):
        def update(self, time: GameTime) -> None:
            if time.frame == 2:
                raise ValueError("no more")

    app = Failing()
    with pytest.raises(ValueError, match="no more"):
        run(app)
    assert app.window is not None
    assert app.window.should_close
