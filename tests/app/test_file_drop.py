"""Files that another program drags into the window of an App."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from moka.app.application import App, GameTime
from moka.app.events import DropEvent, Event
from moka.app.run import run
from moka.commands.command_list import CommandList
from tests.support.display import running_display
from tests.support.file_drag import drop_files
from tests.support.person import Person

pytestmark = [pytest.mark.window, pytest.mark.gpu]


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    glfw = pytest.importorskip("glfw")
    with running_display() as name:
        yield name
        glfw.terminate()


class Basket(App):
    """Keeps what is dropped into it."""

    continuous = False

    def load(self) -> None:
        self.drops: list[tuple[str, ...]] = []

    def event(self, event: Event) -> None:
        if isinstance(event, DropEvent):
            self.drops.append(event.paths)

    def draw(self, time: GameTime, commands: CommandList) -> None:  # noqa: ARG002
        commands.bind_framebuffer(None)
        commands.clear((0.0, 0.0, 0.0, 1.0))


def test_the_event_has_the_paths_of_all_files(
    display: str, tmp_path: Path
) -> None:
    paths = [tmp_path / "a scene.glb", tmp_path / "Größe 100% 地図#1.hdr"]
    for path in paths:
        path.write_bytes(b"")
    basket = Basket()

    def story(person: Person) -> None:
        person.wait("the window", lambda: basket.window is not None)
        drop_files(display, paths, at=(50, 40))
        drop_files(display, paths[:1], at=(10, 10))
        person.wait("both drops", lambda: len(basket.drops) == 2)

    person = Person(basket, display, story)
    person.come()
    try:
        run(basket, size=(200, 150), vsync=False, cache=False)
    finally:
        person.leave()
    both = tuple(str(path) for path in paths)
    assert basket.drops == [both, both[:1]]
