"""A real window on a real display: pictures out, events in."""

import ctypes
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
import pytest
from PIL import ImageGrab

from moka.app import window as window_module
from moka.app.application import App, GameTime
from moka.app.events import (
    CloseEvent,
    Event,
    FocusEvent,
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    ResizeEvent,
    ScrollEvent,
    TextEvent,
)
from moka.app.keys import Key, Modifiers, MouseButton
from moka.app.run import run
from moka.app.window import Window
from moka.backend.contexts import WindowContext
from moka.commands.command_list import CommandList
from moka.core.errors import ContextError
from tests.support.display import running_display

pytestmark = pytest.mark.window

WAIT_S = 10.0

Kind = TypeVar("Kind", bound=Event)


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    glfw = pytest.importorskip("glfw")
    with running_display() as name:
        yield name
        glfw.terminate()


@pytest.fixture
def window(display: str) -> Iterator[Window]:  # noqa: ARG001
    with Window("test", (200, 100), vsync=False, debug=True) as window:
        yield window


@pytest.fixture
def render_thread() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(1, thread_name_prefix="render") as thread:
        yield thread


def wait_for(
    window: Window,
    kind: type[Kind],
    is_last: Callable[[list[Kind]], bool] = bool,
) -> list[Kind]:
    """The events of one kind until ``is_last`` accepts those so far."""
    found: list[Kind] = []
    deadline = time.monotonic() + WAIT_S
    while not is_last(found):
        assert time.monotonic() < deadline, f"only {found} came"
        time.sleep(0.005)
        found += [each for each in window.poll() if isinstance(each, kind)]
    return found


def reached(x: float, y: float) -> Callable[[list[MouseMoveEvent]], bool]:
    """Whether the pointer has come to a place."""
    return lambda moves: bool(moves) and (moves[-1].x, moves[-1].y) == (x, y)


def act(commands: str) -> str:
    """Let xdotool act like a person at the mouse and the keyboard."""
    if shutil.which("xdotool") is None:
        pytest.skip("there is no xdotool")
    return subprocess.run(
        ["xdotool", *commands.split()],
        check=True,
        timeout=WAIT_S,
        capture_output=True,
        text=True,
    ).stdout


def click_on_the_cross(title: str) -> None:
    """Send what a window manager sends (ICCCM 4.2.8.1, WM_DELETE_WINDOW)."""
    target = int(act(f"search --name ^{title}$"))
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    connection = ctypes.c_void_p(x11.XOpenDisplay(None))
    protocols = x11.XInternAtom(connection, b"WM_PROTOCOLS", 0)
    delete = x11.XInternAtom(connection, b"WM_DELETE_WINDOW", 0)
    # An XClientMessageEvent, whose type is 33 and whose data are 32 bits.
    event = (ctypes.c_long * 24)(33, 0, 1, 0, target, protocols, 32, delete)
    x11.XSendEvent(connection, ctypes.c_ulong(target), 0, 0, event)
    x11.XCloseDisplay(connection)


def paint(context: WindowContext, size: tuple[int, int]) -> None:
    """The left half red, the upper right blue, the rest green; shown."""
    width, height = size
    screen = context.gl.screen
    screen.viewport = (0, 0, width, height)
    screen.clear(0, 1, 0)
    screen.clear(1, 0, 0, viewport=(0, 0, width // 2, height))
    top_right = (width // 2, height // 2, width // 2, height // 2)
    screen.clear(0, 0, 1, viewport=top_right)
    context.swap()


def screenshot(display: str, size: tuple[int, int]) -> np.ndarray:
    """What the upper left of the screen shows, (height, width, 3)."""
    box = (0, 0, *size)
    image = ImageGrab.grab(bbox=box, xdisplay=display)
    return np.asarray(image.convert("RGB"))


def test_another_thread_draws_what_the_screen_shows(
    display: str, window: Window, render_thread: ThreadPoolExecutor
) -> None:
    size = window.framebuffer_size
    assert size == (200, 100)
    context = render_thread.submit(window.context_factory()).result()
    assert context.kind == "window"
    render_thread.submit(paint, context, size).result()
    deadline = time.monotonic() + WAIT_S
    while not screenshot(display, size)[50, 50].any():
        assert time.monotonic() < deadline
        window.poll()
    pixels = screenshot(display, size)
    assert (pixels[:, :100] == (255, 0, 0)).all()
    assert (pixels[:50, 100:] == (0, 0, 255)).all()
    assert (pixels[50:, 100:] == (0, 255, 0)).all()
    assert context.drain_debug_messages() == []
    render_thread.submit(context.close).result()


def test_it_has_colour_and_nothing_that_no_pass_uses(
    window: Window, render_thread: ThreadPoolExecutor
) -> None:
    def bits(context: WindowContext) -> list[int]:
        read = context.function(
            "glGetFramebufferAttachmentParameteriv",
            *(None, *(ctypes.c_uint,) * 3, ctypes.c_void_p),
        )
        back, depth, stencil = 0x0402, 0x1801, 0x1802
        object_type = 0x8CD0
        found = []
        for attachment in (back, depth, stencil):
            value = ctypes.c_int(-1)
            read(0x8D40, attachment, object_type, ctypes.byref(value))
            found.append(value.value)
        return found

    context = render_thread.submit(window.context_factory()).result()
    default, none = 0x8218, 0
    assert render_thread.submit(bits, context).result() == [default, none, none]
    assert context.drain_debug_messages() == []
    render_thread.submit(context.close).result()


def test_a_window_stays_while_a_thread_draws_into_it(
    window: Window, render_thread: ThreadPoolExecutor
) -> None:
    context = render_thread.submit(window.context_factory()).result()
    with pytest.raises(ContextError, match="belongs to thread render"):
        window.close()
    render_thread.submit(context.close).result()
    window.close()
    window.close()
    assert window.should_close


def test_windows_follow_one_another(
    display: str,  # noqa: ARG001
    render_thread: ThreadPoolExecutor,
) -> None:
    for _ in range(3):
        with Window("test", (64, 64), visible=False, vsync=False) as window:
            context = render_thread.submit(window.context_factory()).result()
            render_thread.submit(paint, context, (64, 64)).result()
            render_thread.submit(context.close).result()


def test_keys(window: Window) -> None:
    act("mousemove 50 50 key a shift+Left F5 KP_3")
    keys = wait_for(
        window,
        KeyEvent,
        lambda keys: any(each.key is Key.KEYPAD_3 for each in keys),
    )
    assert [(each.key, each.pressed) for each in keys[:2]] == [
        (Key.A, True),
        (Key.A, False),
    ]
    modifiers = {each.key: each.modifiers for each in keys if each.pressed}
    assert modifiers[Key.A] is Modifiers.NONE
    assert modifiers[Key.LEFT] is Modifiers.SHIFT
    assert {Key.F5, Key.LEFT_SHIFT} <= set(modifiers)


def test_text(window: Window) -> None:
    act("mousemove 50 50 key a Left shift+b exclam")
    typed = wait_for(window, TextEvent, lambda typed: len(typed) == 3)
    assert "".join(each.text for each in typed) == "aB!"


def test_motion_adds_up(window: Window) -> None:
    act("mousemove 20 30")
    wait_for(window, MouseMoveEvent, reached(20, 30))
    act("mousemove 50 10 mousemove 60 40 mousemove 25 31")
    moves = wait_for(window, MouseMoveEvent, reached(25, 31))
    assert sum(each.dx for each in moves) == 5
    assert sum(each.dy for each in moves) == 1


def test_buttons(window: Window) -> None:
    act("mousemove 50 10 click 1 click 3 click 2")
    events = wait_for(window, MouseButtonEvent, lambda each: len(each) == 6)
    assert events == [
        MouseButtonEvent(button, pressed, 50.0, 10.0, Modifiers.NONE)
        for button in (MouseButton.LEFT, MouseButton.RIGHT, MouseButton.MIDDLE)
        for pressed in (True, False)
    ]


def test_a_button_beyond_three(window: Window) -> None:
    act("mousemove 50 10 keydown super click 8 keyup super")
    events = wait_for(window, MouseButtonEvent, lambda each: len(each) == 2)
    assert events == [
        MouseButtonEvent(
            MouseButton.BUTTON_4, pressed, 50.0, 10.0, Modifiers.SUPER
        )
        for pressed in (True, False)
    ]


def test_the_pointer_moves_by_fractions(window: Window) -> None:
    """As on screens with a scale; a library that rounds would lose them."""
    for x in (10.0, 10.25, 10.75):
        window._window.glfw_mouse_event_callback(None, x, 20.0)
    moves = wait_for(window, MouseMoveEvent, lambda each: len(each) >= 3)
    assert [(each.x, each.dx) for each in moves[:3]] == [
        (10.0, 0.0),
        (10.25, 0.25),
        (10.75, 0.5),
    ]


def test_the_wheel(window: Window) -> None:
    act("mousemove 50 10 click 4 click 5")
    turns = wait_for(window, ScrollEvent, lambda turns: len(turns) == 2)
    assert turns == [ScrollEvent(0.0, 1.0), ScrollEvent(0.0, -1.0)]


def test_a_new_size(window: Window) -> None:
    act("search --name ^test$ windowsize 160 90")
    wait_for(window, ResizeEvent, lambda sizes: ResizeEvent(160, 90) in sizes)
    assert window.framebuffer_size == (160, 90)
    assert window.size == (160, 90)


def test_a_click_on_the_cross(window: Window) -> None:
    assert not window.should_close
    click_on_the_cross("test")
    wait_for(window, CloseEvent)
    assert window.should_close


def test_a_request_to_close(window: Window) -> None:
    window.request_close()
    assert window.should_close


def test_the_title_changes(window: Window) -> None:
    window.set_title("other")
    act("search --name ^other$")


@pytest.mark.usefixtures("display")
def test_only_the_main_thread_makes_windows() -> None:
    errors: list[ContextError] = []

    def open_window() -> None:
        with pytest.raises(ContextError, match="main thread") as info:
            Window()
        errors.append(info.value)

    thread = threading.Thread(target=open_window)
    thread.start()
    thread.join()
    assert errors


@pytest.mark.parametrize("package", ["glfw", "moderngl_window.context.base"])
def test_without_its_packages_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    monkeypatch.delitem(sys.modules, "moka.app.window_glfw", raising=False)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ContextError, match=r"moka-pbr\[window\]"):
        Window()


def test_a_window_that_cannot_be_opened_ends_no_other(
    monkeypatch: pytest.MonkeyPatch, window: Window
) -> None:
    glfw = pytest.importorskip("glfw")
    with monkeypatch.context() as patch:
        patch.setattr(glfw, "create_window", lambda *_: None)
        with pytest.raises(ContextError, match="no window can be opened"):
            Window()
    act("mousemove 50 10 click 1")
    assert wait_for(window, MouseButtonEvent)


def test_a_minimised_window_is_hidden(window: Window) -> None:
    """As GLFW reports it; nobody minimises windows without a manager."""
    window._window.glfw_window_iconify(None, 1)
    assert window.is_hidden
    window._window.glfw_window_iconify(None, 0)
    assert not window.is_hidden


def test_without_a_display_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    glfw = pytest.importorskip("glfw")
    glfw.terminate()
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(ContextError, match="run with a display") as info:
        Window()
    assert "\n" not in str(info.value)


def test_every_key_has_a_code() -> None:
    pytest.importorskip("glfw")
    assert set(window_module._keys().values()) == set(Key)


def test_the_keyboard_goes_elsewhere_and_comes_back(window: Window) -> None:
    with Window("other", (50, 50), vsync=False):
        wait_for(
            window,
            FocusEvent,
            lambda seen: seen[-1:] == [FocusEvent(False)],
        )


def test_a_woken_window_does_not_wait_on(window: Window) -> None:
    window.poll()
    started = time.monotonic()
    timer = threading.Timer(0.05, window.wake)
    timer.start()
    window.poll(timeout=WAIT_S)
    timer.join()
    assert time.monotonic() - started < WAIT_S / 2


def test_full_screen_and_back(window: Window) -> None:
    assert not window.fullscreen
    before = window.size
    window.fullscreen = True
    (event,) = wait_for(window, ResizeEvent)[-1:]
    assert window.fullscreen
    assert event.width > before[0]
    window.fullscreen = False
    wait_for(window, ResizeEvent)
    assert window.size == before
    assert not window.fullscreen


def test_a_display_of_twice_the_scale(display: str) -> None:
    """X11 enlarges text by a resource and never pixels."""
    glfw = pytest.importorskip("glfw")
    xlib = pytest.importorskip("Xlib.display")
    connection = xlib.Display(display)
    root = connection.screen().root
    manager = connection.intern_atom("RESOURCE_MANAGER")
    text = connection.intern_atom("STRING")
    before = root.get_full_property(manager, text)
    root.change_property(manager, text, 8, b"Xft.dpi:\t192\n")
    connection.sync()
    # It is read once.
    glfw.terminate()
    try:
        with Window("test", (200, 100), vsync=False) as window:
            assert window.content_scale == 2.0
            assert window.size == window.framebuffer_size == (200, 100)
    finally:
        if before is None:
            root.delete_property(manager)
        else:
            root.change_property(manager, text, 8, before.value)
        connection.close()
        glfw.terminate()


def test_the_clipboard_keeps_a_text(window: Window) -> None:
    window.clipboard = "moka render hélmet.glb"
    assert window.clipboard == "moka render hélmet.glb"


def test_a_captured_pointer_is_given_back(window: Window) -> None:
    assert not window.captures_pointer
    window.captures_pointer = True
    assert window.captures_pointer
    window.captures_pointer = False
    assert not window.captures_pointer
    assert window.content_scale >= 1.0
    assert not window.is_hidden
    assert isinstance(window.gamepads, list)


@pytest.mark.gpu
@pytest.mark.parametrize("continuous", [True, False])
def test_frames_follow_one_another_without_any_event(
    display: str,  # noqa: ARG001
    continuous: bool,
) -> None:
    """Also where a frame is asked for while the one before is handed over."""

    class Busy(App):
        def draw(self, time: GameTime, commands: CommandList) -> None:  # noqa: ARG002
            commands.bind_framebuffer(None)
            commands.clear((0.0, 0.0, 0.0, 1.0))
            if not self.continuous:
                self.request_redraw()

    Busy.continuous = continuous
    start = time.perf_counter()
    run(Busy, frames=40, size=(64, 64), vsync=False, cache=False)
    # A wait for events that do not come is of half a second.
    assert time.perf_counter() - start < 10.0


def test_an_egl_context_of_somebody_else_is_no_obstacle(
    display: str,  # noqa: ARG001
    render_thread: ThreadPoolExecutor,
) -> None:
    """GLX ended the process without a word."""
    moderngl = pytest.importorskip("moderngl")
    for is_released in (False, True):
        try:
            foreign = moderngl.create_standalone_context(backend="egl")
        except Exception:
            pytest.skip("there is no EGL")
        if is_released:
            foreign.release()
        for _ in range(2):
            with Window("beside", (50, 40), vsync=False) as window:
                factory = window.context_factory()
                context = render_thread.submit(factory).result()
                size = window.framebuffer_size
                render_thread.submit(paint, context, size).result()
                render_thread.submit(context.close).result()
