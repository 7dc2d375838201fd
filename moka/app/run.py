"""The loop behind an App: in a window, or headless."""

import contextlib
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from moka.app.application import App
from moka.app.clock import Clock
from moka.app.events import ResizeEvent
from moka.commands.command_list import CommandList
from moka.core.errors import OptionError
from moka.graphics.device import GraphicsDevice
from moka.lighting.disk_cache import DiskCache
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings

if TYPE_CHECKING:
    from moka.app.window import Window

__all__ = ["run"]

# Headless frames are evenly spaced, so that they can be compared.
HEADLESS_DELTA = 1 / 60

# How long, in seconds, a loop with nothing to draw sleeps unless woken.
_NAP = 0.5

# How long, in seconds, a frame may keep the window from what happens to it.
_ANSWER = 0.05


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
    fullscreen: bool = False,
    debug: bool = False,
    cache: bool = True,
) -> App:
    """Run ``app`` until it quits, its window closes or ``frames`` are done.

    ``app`` is an :class:`moka.App` or a subclass, which is then made here.
    ``size`` is in pixels (in a window, screen coordinates), which a
    ``fullscreen`` window takes from the screen. ``headless``
    needs no display and runs one frame unless ``frames`` says otherwise;
    its time advances by 1/60 s a frame and its last frame is left in
    ``app.image``. Reference lighting completes that last one: its moment is
    drawn again, without an update, until all samples are taken.
    ``settings`` are a :class:`RenderSettings`, as
    :func:`moka.settings_of_quality` makes them, ``backend`` is that of
    ``moka render``, ``debug`` turns GL errors into exceptions, ``cache`` says
    whether preintegrated lighting is read from disk and, at the end, written
    there.

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
            fullscreen=fullscreen,
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
        clock = Clock()
        for number in range(frames):
            elapsed = HEADLESS_DELTA if number else 0.0
            commands = _record(app, clock, elapsed)
            is_last = app.quits or number == frames - 1
            if not is_last:
                device.submit(commands)
                continue
            commands = _completed(app, clock, commands, settings)
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
                    gamma=settings.gamma,
                    display=display.data[::-1],
                )
            break


def _completed(
    app: App, clock: Clock, commands: CommandList, settings: RenderSettings
) -> CommandList:
    """What shows the last frame, drawn on until nothing more would come.

    Bounded, for an app whose drawing moves something and begins anew.
    """
    for _ in range(settings.sample_budget):
        if not app.renderer.has_drawn or app.renderer.is_complete:
            break
        app.device.submit(commands).wait()
        commands = CommandList()
        app.draw(clock.frame(0.0, paused=app.paused), commands)
    return commands


def _run_in_window(
    app: App,
    frames: int | None,
    size: tuple[int, int],
    title: str,
    settings: RenderSettings | None,
    cache: DiskCache | None,
    *,
    vsync: bool,
    fullscreen: bool,
    debug: bool,
) -> None:
    from moka.app.window import Window
    from moka.backend.moderngl_backend import ModernGLBackend
    from moka.graphics.shader_source import explain_log

    with Window(
        title, size, vsync=vsync, fullscreen=fullscreen, debug=debug
    ) as window:
        make_context = window.context_factory()
        pixels = window.framebuffer_size
        app.window = window
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
            _loop(app, window, frames)


def _loop(app: App, window: "Window", frames: int | None) -> None:
    """Draw frames until somebody has had enough of them."""
    clock = Clock()
    before = due = time.perf_counter()
    is_wanted = True
    number = 0
    while not (window.should_close or app.quits):
        # Before the wait: whoever asked while the last frame was handed over
        # has woken the window already.
        is_wanted |= _wants_frame(app)
        wait = max(due - time.perf_counter(), 0.0) if is_wanted else _NAP
        for event in window.poll(_NAP if window.is_hidden else wait):
            _dispatch(app, event)
            is_wanted = True
        is_wanted |= _wants_frame(app)
        now = time.perf_counter()
        if window.is_hidden or not is_wanted or now < due:
            continue
        app.input.gamepads = window.gamepads
        commands = _record(app, clock, now - before if number else 0.0)
        recorded = time.perf_counter()
        while not app.device.is_ready(_ANSWER):
            # A long frame before this one: the window answers all the same.
            for event in window.poll():
                _dispatch(app, event)
        app.frame = app.device.submit_and_present(commands)
        app.waited = time.perf_counter() - recorded
        before = now
        due = now + 1 / app.frame_limit if app.frame_limit else now
        is_wanted = False
        number += 1
        if number == frames:
            break


def _wants_frame(app: App) -> bool:
    """Whether another frame would show something else, or was asked for."""
    return (
        app.take_redraw_request()
        or app.continuous
        or (app.scene.is_animating and not app.paused)
        or not app.renderer.is_complete
    )


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


def _record(app: App, clock: Clock, elapsed: float) -> CommandList:
    """Update the app, and record its frame."""
    has_updated = False
    updates = clock.advance(
        elapsed, fixed_step=app.fixed_step, paused=app.paused
    )
    for moment in updates:
        app.scene.animate(moment.delta)
        app.update(moment)
        has_updated = True
        # Seen once: no second update of this frame sees a key go down.
        app.input.forget_changes()
    if app.paused and not has_updated:
        app.input.forget_changes()
    commands = CommandList()
    app.draw(clock.frame(elapsed, paused=app.paused), commands)
    return commands


def _dispatch(app: App, event: Any) -> None:
    if isinstance(event, ResizeEvent) and event.width and event.height:
        app.renderer.size = (event.width, event.height)
        app.resize(event.width, event.height)
    app.input.take(event)
    app.event(event)
