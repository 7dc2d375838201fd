"""App: what a program with a loop subclasses."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from moka.app.input import Input
from moka.scene.camera import Camera
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.app.events import Event
    from moka.app.window import Window
    from moka.commands.command_list import CommandList
    from moka.core.image import Image
    from moka.graphics.device import Frame, GraphicsDevice
    from moka.renderer.renderer import Renderer

__all__ = ["App", "GameTime"]


@dataclass(frozen=True, slots=True)
class GameTime:
    """When an update or a frame happens.

    ``delta`` seconds since the one before (0 in the first), ``total``
    seconds since the first, ``frame`` its number from 0. Time stands still
    while the app is paused.
    """

    delta: float = 0.0
    total: float = 0.0
    frame: int = 0


class App:
    """Subclass it, override what you need, and give it to :func:`moka.run`.

    While it runs, ``device`` and ``renderer`` exist; ``scene`` and
    ``camera`` are there from the start and may be replaced. ``size`` is the
    picture's width and height in pixels. ``input`` is what is held and
    pressed, ``window`` the window; a headless run has None, and leaves the
    last frame in ``image``. ``frame`` is the last one that a window's loop
    has submitted: when it is done, its counters tell of the work. Before
    it the loop has ``waited``, in seconds, for the one before.

    These may be set at any time, or in the class: ``fixed_step``, seconds
    between two updates, or None for one before each frame; ``paused``, while
    which time stands still and nothing is updated; ``frame_limit``, how many
    frames are drawn per second at most; ``continuous``, whether one frame
    follows another. If not, one is drawn after an event, after
    :meth:`request_redraw`, while an animation plays, and until the picture
    is complete: an app that shows what does not move costs nothing while
    nobody touches it.
    """

    device: "GraphicsDevice"
    renderer: "Renderer"
    window: "Window | None" = None
    image: "Image | None" = None
    frame: "Frame | None" = None
    waited: float = 0.0

    fixed_step: float | None = None
    paused: bool = False
    frame_limit: float | None = None
    continuous: bool = True

    def __init__(self) -> None:
        self.scene = Scene()
        self.camera = Camera()
        self.input = Input()
        self._quits = False
        self._redraw_requested = False

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

    def request_redraw(self) -> None:
        """Have a frame drawn soon, if none is anyway; from any thread."""
        self._redraw_requested = True
        if self.window is not None:
            self.window.wake()

    def take_redraw_request(self) -> bool:
        """Whether a frame was asked for since the last call; for the loop."""
        requested, self._redraw_requested = self._redraw_requested, False
        return requested

    def load(self) -> None:
        """Called once, after the device exists and before the first frame.

        By default does nothing. A camera that nobody has placed frames the
        scene afterwards.
        """

    def update(self, time: GameTime) -> None:
        """Move things; called before a frame, see ``fixed_step``.

        Animations that play have moved theirs before.
        """

    def draw(self, time: GameTime, commands: "CommandList") -> None:  # noqa: ARG002
        """Record the frame; by default the scene seen by the camera."""
        self.renderer.draw(self.scene, self.camera, commands)

    def resize(self, width: int, height: int) -> None:
        """The picture has a new size in pixels."""

    def event(self, event: "Event") -> None:
        """Something happened to the window; see :mod:`moka.app.events`.

        ``input`` says the same as a state, which is easier to ask in
        :meth:`update`.
        """

    def close(self) -> None:
        """Called once at the end, also after an error, before the device."""
