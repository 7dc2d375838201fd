"""App: what a program with a loop subclasses."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from moka.scene.camera import Camera
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.app.events import Event
    from moka.commands.command_list import CommandList
    from moka.core.image import Image
    from moka.graphics.device import GraphicsDevice
    from moka.renderer.renderer import Renderer

__all__ = ["App", "GameTime"]


@dataclass(frozen=True, slots=True)
class GameTime:
    """When a frame happens.

    ``delta`` seconds since the frame before (0 in the first), ``total``
    seconds since the first, ``frame`` its number from 0.
    """

    delta: float = 0.0
    total: float = 0.0
    frame: int = 0


class App:
    """Subclass it, override what you need, and give it to :func:`moka.run`.

    While it runs, ``device`` and ``renderer`` exist; ``scene`` and
    ``camera`` are there from the start and may be replaced. ``size`` is the
    picture's width and height in pixels. A headless run leaves the last
    frame in ``image``.
    """

    device: "GraphicsDevice"
    renderer: "Renderer"
    image: "Image | None" = None

    def __init__(self) -> None:
        self.scene = Scene()
        self.camera = Camera()
        self._quits = False

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels."""
        return self.renderer.size

    @property
    def quits(self) -> bool:
        """Whether :meth:`quit` has been called."""
        return self._quits

    def quit(self) -> None:
        """End the loop after this frame."""
        self._quits = True

    def load(self) -> None:
        """Called once, after the device exists and before the first frame.

        By default does nothing. A camera that nobody has placed frames the
        scene afterwards.
        """

    def update(self, time: GameTime) -> None:
        """Move things; called once before each frame.

        Animations that play have moved theirs before.
        """

    def draw(self, time: GameTime, commands: "CommandList") -> None:  # noqa: ARG002
        """Record the frame; by default the scene seen by the camera."""
        self.renderer.draw(self.scene, self.camera, commands)

    def resize(self, width: int, height: int) -> None:
        """The picture has a new size in pixels."""

    def event(self, event: "Event") -> None:
        """Something happened to the window; see :mod:`moka.app.events`."""

    def close(self) -> None:
        """Called once at the end, also after an error, before the device."""
