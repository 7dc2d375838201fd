"""The loop behind an App: in a window, or headless."""

import contextlib
import time
from collections.abc import Iterator
from typing import Any

from moka.app.application import App, GameTime
from moka.app.events import ResizeEvent
from moka.commands.command_list import CommandList
from moka.core.errors import OptionError
from moka.graphics.device import GraphicsDevice
from moka.lighting.disk_cache import DiskCache
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings

__all__ = ["run"]

# Headless frames are evenly spaced, so that they can be compared.
HEADLESS_DELTA = 1 / 60

# A frame after a stall (a breakpoint, a window being dragged) must not make
# things jump.
LONGEST_DELTA = 0.25


def run(
    app: App | type[App],
    *,
    headless: bool = False,
    frames: int | None = None,
    size: tuple[int, int] = (1280, 720),
    title: str = "moka",
    settings: RenderSettings | None = None,
    backend: str = "auto",
    vsync: bool = True,
    debug: bool = False,
    cache: bool = True,
) -> App:
    """Run ``app`` until it quits, its window closes or ``frames`` are done.

    ``app`` is an :class:`moka.App` or a subclass, which is then made here.
    ``size`` is in pixels (in a window, screen coordinates). ``headless``
    needs no display and runs one frame unless ``frames`` says otherwise;
    its time advances by 1/60 s a frame and its last frame is left in
    ``app.image``. ``settings`` are a :class:`RenderSettings`, ``backend``
    is that of ``moka render``, ``debug`` turns GL errors into exceptions,
    ``cache`` says whether preintegrated lighting is read from disk and,
    at the end, written there.

    Returns the app. Whatever a callback raises ends the loop, closes window
    and device, and is raised here with its own traceback. Raises
    ContextError where no context or window can be had.
    """
    if frames is not None and frames < 1:
        raise OptionError(f"run: {frames} frames are not at least 1")
    running = app() if isinstance(app, type) else app
    files = DiskCache() if cache else None
    if headless:
        _run_headless(
            running, frames or 1, size, settings, backend, files, debug=debug
        )
    else:
        _run_in_window(
            running,
            frames,
            size,
            title,
            settings,
            files,
            vsync=vsync,
            debug=debug,
        )
    return running


def _run_headless(
    app: App,
    frames: int,
    size: tuple[int, int],
    settings: RenderSettings | None,
    backend: str,
    cache: DiskCache | None,
    *,
    debug: bool,
) -> None:
    from moka.core.image import Image

    settings = settings or RenderSettings(float_output=True)
    with (
        GraphicsDevice.open(backend, debug=debug) as device,
        _opened(app, device, Renderer(device, size, settings, cache=cache)),
    ):
        for number in range(frames):
            moment = GameTime(
                HEADLESS_DELTA if number else 0.0,
                number * HEADLESS_DELTA,
                number,
            )
            commands = _record(app, moment)
            is_last = app.quits or number == frames - 1
            if not is_last:
                device.submit(commands)
                continue
            reads = app.renderer.has_drawn
            if reads:
                radiance = app.renderer.read_radiance(commands)
                display = app.renderer.read_display(commands)
            device.submit(commands).wait()
            if reads:
                assert radiance.data is not None
                assert display.data is not None
                app.image = Image(
                    radiance.data[::-1],
                    tone_map=settings.tone_map,
                    exposure=settings.exposure,
                    display=display.data[::-1],
                )
            break


def _run_in_window(
    app: App,
    frames: int | None,
    size: tuple[int, int],
    title: str,
    settings: RenderSettings | None,
    cache: DiskCache | None,
    *,
    vsync: bool,
    debug: bool,
) -> None:
    from moka.app.window import Window
    from moka.backend.moderngl_backend import ModernGLBackend
    from moka.graphics.shader_source import explain_log

    with Window(title, size, vsync=vsync, debug=debug) as window:
        make_context = window.context_factory()
        pixels = window.framebuffer_size
        with (
            GraphicsDevice(
                lambda: ModernGLBackend(make_context(), explain_log)
            ) as device,
            _opened(
                app,
                device,
                Renderer(device, pixels, settings, to_window=True, cache=cache),
            ),
        ):
            started = before = time.perf_counter()
            number = 0
            while not (window.should_close or app.quits):
                for event in window.poll():
                    _dispatch(app, event)
                if 0 in window.framebuffer_size:
                    # Minimised: nothing to draw into, nothing to hurry for.
                    time.sleep(0.05)
                    continue
                now = time.perf_counter()
                moment = GameTime(
                    min(now - before, LONGEST_DELTA) if number else 0.0,
                    now - started,
                    number,
                )
                before = now
                device.submit_and_present(_record(app, moment))
                number += 1
                if number == frames:
                    break


@contextlib.contextmanager
def _opened(
    app: App, device: GraphicsDevice, renderer: Renderer
) -> Iterator[None]:
    """Give the app its device, load it, and close it in every case."""
    app.device = device
    app.renderer = renderer
    try:
        untouched = app.camera.transform.world_matrix.copy()
        app.load()
        # A camera that nobody placed would stand inside the model.
        if (app.camera.transform.world_matrix == untouched).all():
            width, height = renderer.size
            app.camera.frame(app.scene.bounds(), width / height)
        yield
        renderer.keep_lighting()
    finally:
        try:
            app.close()
        finally:
            renderer.close()


def _record(app: App, moment: GameTime) -> CommandList:
    commands = CommandList()
    app.scene.animate(moment.delta)
    app.update(moment)
    app.draw(moment, commands)
    return commands


def _dispatch(app: App, event: Any) -> None:
    if isinstance(event, ResizeEvent) and event.width and event.height:
        app.renderer.size = (event.width, event.height)
        app.resize(event.width, event.height)
    app.event(event)
