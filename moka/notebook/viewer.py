"""A widget that shows a scene in a notebook and lets a person turn it.

jupyter_rfb carries frames to the page and events back; both arrive in the
kernel's event loop. Frames are drawn on demand, by a headless device on its
own render thread.
"""

import time
from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.app.render_request import request_of
from moka.app.render_session import RenderSession
from moka.commands.command_list import CommandList
from moka.core.errors import DeviceError, OptionError
from moka.core.image import Image
from moka.core.option_text import LARGEST_SIDE
from moka.core.statistics import Statistics
from moka.ui.orbit_controls import OrbitControls

try:
    from jupyter_rfb import RemoteFrameBuffer
except ImportError as error:
    raise OptionError(
        "the viewer of notebooks needs jupyter_rfb: "
        "pip install 'moka-pbr[notebook]'"
    ) from error

__all__ = ["Viewer"]

# What the wheel reports for one of its clicks.
_WHEEL_CLICK = 100.0

_LEFT, _RIGHT, _MIDDLE = 1, 2, 3


class Viewer(RemoteFrameBuffer):  # type: ignore[misc]
    """Shows a model in a cell's output: its last expression, or `display`.

    ``source`` and ``options`` are those of :func:`moka.render`, ``size`` the
    widget's width and height in the page's pixels, which a person can change
    by its corner. Dragging orbits; dragging with the right or the middle
    button or with Shift moves; the wheel comes nearer to what is under the
    pointer; a double click shows everything again.

    ``scene``, ``model``, ``camera``, ``controls`` and ``renderer`` are what
    is shown and how. Change them and call :meth:`request_draw`; nothing is
    drawn unless something asks for it, an animation plays, or reference
    lighting is not complete. A camera that is moved by hand stays where it is
    until the next gesture; ``controls.look_from(camera)`` goes on from there.

    :meth:`close` ends the render thread and frees what the GPU holds. Raises
    what :func:`moka.render` does.
    """

    # The events of the renderview specification, without older names.
    _event_compatibility = 2

    # None while there is nothing to draw with, as when opening it has failed.
    _session: RenderSession | None = None

    def __init__(
        self,
        source: Any = None,
        *,
        size: tuple[int, int] = (640, 360),
        cache: bool = True,
        **options: Any,
    ) -> None:
        super().__init__()
        request = request_of(source, size=size, **options)
        # What is only looked at needs no float32.
        settings = replace(request.settings, float_output=False)
        self._opened = ExitStack()
        session = self._opened.enter_context(
            RenderSession.open(
                replace(request, settings=settings),
                Statistics(),
                cache=cache,
                moves=True,
            )
        )
        self._session = session
        self.scene = session.scene
        self.model = session.model
        self.renderer = session.renderer
        self.camera = session.camera
        self.controls = OrbitControls()
        bounds = self.scene.bounds()
        centre = np.zeros(3) if bounds is None else np.mean(bounds, axis=0)
        distance = float(np.linalg.norm(self.camera.position - centre))
        self.controls.look_from(self.camera, distance or 1.0)
        # In the page's pixels, which may be several of the picture.
        self._page_size = (float(size[0]), float(size[1]))
        self._pointer = (0.0, 0.0)
        self._drawn_at: float | None = None
        self.css_width, self.css_height = f"{size[0]}px", f"{size[1]}px"

    @property
    def is_closed(self) -> bool:
        """Whether nothing more can be drawn."""
        return self._session is None

    def image(self) -> Image:
        """What is shown, as :func:`moka.render` would make it.

        Complete, also under reference lighting, which takes its time. Its
        size is that of the widget in the picture's pixels.
        """
        session = self._opened_session()
        return session.submit(want_pixels=True, want_display=True).wait()

    def get_frame(self) -> NDArray[np.uint8]:
        """The next frame, (H, W, 4), for the widget's own machinery."""
        session = self._opened_session()
        self._animate()
        commands = CommandList()
        self.renderer.draw(self.scene, self.camera, commands)
        readback = self.renderer.read_display(commands)
        session.device.submit(commands).wait()
        if self.scene.is_animating or not self.renderer.is_complete:
            self.request_draw()
        assert readback.data is not None
        pixels: NDArray[np.uint8] = readback.data[::-1]
        if self.scene.background == "transparent":
            # What carries frames to the page has no alpha.
            return _over_white(pixels)
        return np.ascontiguousarray(pixels)

    def handle_event(self, event: Mapping[str, Any]) -> None:
        """Follow the page; ``event`` is one of the renderview spec."""
        if self.is_closed:
            return
        match event["type"]:
            case "close":
                self._release()
            case "resize":
                self._resize(event)
            case "pointer_down":
                self._pointer = event["x"], event["y"]
            case "pointer_move" if event["buttons"]:
                self._drag(event)
            case "wheel":
                self._zoom(event)
            case "double_click":
                self._show_everything()

    def _resize(self, event: Mapping[str, Any]) -> None:
        if not event["width"] or not event["height"]:
            return  # It is not on the page.
        self._page_size = event["width"], event["height"]
        width, height = (
            min(max(round(side * event["ratio"]), 1), LARGEST_SIDE)
            for side in self._page_size
        )
        self.renderer.size = width, height
        self.request_draw()

    def _drag(self, event: Mapping[str, Any]) -> None:
        height = self._page_size[1]
        x, y = event["x"], event["y"]
        across = (x - self._pointer[0]) / height
        down = (y - self._pointer[1]) / height
        self._pointer = x, y
        pans = {_RIGHT, _MIDDLE}.intersection(event["buttons"])
        if pans or "Shift" in event["modifiers"]:
            self.controls.pan(across, down, self.camera)
        else:
            self.controls.orbit(across, down)
        self._look()

    def _zoom(self, event: Mapping[str, Any]) -> None:
        width, height = self._page_size
        pointer = (
            (2.0 * event["x"] - width) / height,
            1.0 - 2.0 * event["y"] / height,
        )
        clicks = -event["dy"] / _WHEEL_CLICK
        self.controls.zoom(clicks, self.camera, pointer)
        self._look()

    def _show_everything(self) -> None:
        width, height = self.renderer.size
        self.controls.frame(self.scene.bounds(), self.camera, width / height)
        self._look()

    def _look(self) -> None:
        self.controls.apply(self.camera)
        self.request_draw()

    def _animate(self) -> None:
        """Let the time since the last frame pass, if an animation plays."""
        now = time.perf_counter()
        if self._drawn_at is not None and self.scene.is_animating:
            self.scene.animate(now - self._drawn_at)
        self._drawn_at = now if self.scene.is_animating else None

    def _release(self) -> None:
        session, self._session = self._opened_session(), None
        with self._opened:
            session.keep_lighting()

    def _opened_session(self) -> RenderSession:
        if self._session is None:
            raise DeviceError("notebook viewer: it is closed; make another one")
        return self._session


def _over_white(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Encoded colours with alpha that is not associated, over white."""
    alpha = pixels[:, :, 3:] / np.float32(255)
    shown = pixels * alpha + 255 * (1 - alpha)
    return np.rint(shown).astype(np.uint8)
