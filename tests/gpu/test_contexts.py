"""Real contexts: made, shared between threads, used side by side."""

import ctypes
import gc
import threading
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import moderngl
import numpy as np
import pytest

from moka.backend.contexts import (
    GraphicsContext,
    NativeContext,
    Severity,
    candidates,
    egl,
    open_context,
)
from moka.core.errors import ContextError
from tests.support.display import running_display

pytestmark = pytest.mark.gpu

Open = Callable[..., GraphicsContext]


def _opener(backend: str) -> Open:
    """Open a context of ``backend``; skip where its library is not."""

    def open_(**settings: bool) -> GraphicsContext:
        try:
            return open_context(backend, **settings)
        except ContextError as error:
            if "cannot open shared object file" in str(error):
                pytest.skip(str(error))
            raise

    return open_


@pytest.fixture(params=["egl", "surfaceless", "osmesa"])
def open_headless(request: pytest.FixtureRequest) -> Open:
    """A way to a context without a display."""
    if request.param == "surfaceless":
        return candidates("egl")[1].open
    return _opener(request.param)


@pytest.fixture
def context(open_headless: Open) -> Iterator[GraphicsContext]:
    """A debug context that is closed in the end."""
    with open_headless(debug=True) as context:
        yield context


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    with running_display() as name:
        yield name


def draw(gl: moderngl.Context, colour: tuple[float, ...]) -> np.ndarray:
    """A triangle over an 8x8 target with a depth buffer, read back.

    Returns (8, 8, 5): red, green, blue, alpha, depth.
    """
    program = gl.program(
        vertex_shader="""
            #version 330 core
            const vec2 corners[3] = vec2[](
                vec2(-1, -1), vec2(3, -1), vec2(-1, 3));
            void main() {
                gl_Position = vec4(corners[gl_VertexID], 0.5, 1);
            }
        """,
        fragment_shader="""
            #version 330 core
            uniform vec4 colour;
            out vec4 result;
            void main() { result = colour; }
        """,
    )
    program["colour"].value = colour
    target = gl.texture((8, 8), 4, dtype="f4")
    depth = gl.depth_texture((8, 8))
    framebuffer = gl.framebuffer([target], depth)
    framebuffer.use()
    framebuffer.clear(depth=1.0)
    gl.enable(gl.DEPTH_TEST)
    gl.vertex_array(program, []).render(vertices=3)
    pixels = np.frombuffer(target.read(), "f4").reshape(8, 8, 4)
    depths = np.frombuffer(depth.read(), "f4").reshape(8, 8, 1)
    return np.concatenate([pixels, depths], axis=2)


def assert_drawn(pixels: np.ndarray, colour: tuple[float, ...]) -> None:
    expected = np.broadcast_to([*colour, 0.75], (8, 8, 5))
    np.testing.assert_allclose(pixels, expected, atol=1e-6)


def test_a_context_draws(context: GraphicsContext) -> None:
    assert context.gl.version_code >= 330
    assert_drawn(draw(context.gl, (0.25, 0.5, 2.0, 1.0)), (0.25, 0.5, 2, 1))
    assert context.drain_debug_messages() == []


def test_a_context_describes_itself(context: GraphicsContext) -> None:
    description = context.describe()
    assert description["backend"] == context.kind
    assert description["context"] == context.label
    assert all(
        description[name] for name in ("vendor", "renderer", "version", "glsl")
    )


def test_functions_are_bound_once(context: GraphicsContext) -> None:
    finish = context.function("glFinish", None)
    finish()
    assert context.function("glFinish", None) is finish
    get = context.function(
        "glGetIntegerv", None, ctypes.c_uint, ctypes.c_void_p
    )
    value = ctypes.c_int()
    get(0x821B, ctypes.byref(value))
    assert value.value == context.gl.version_code // 100


def test_cube_filtering_is_seamless(context: GraphicsContext) -> None:
    is_enabled = context.function("glIsEnabled", ctypes.c_ubyte, ctypes.c_uint)
    assert is_enabled(0x884F)


def test_the_driver_reports_errors(context: GraphicsContext) -> None:
    context.function("glEnable", None, ctypes.c_uint)(0x12345)
    (message,) = context.drain_debug_messages()
    assert message.is_error
    assert message.severity is Severity.HIGH
    assert "glEnable" in message.text
    assert context.drain_debug_messages() == []


def test_dropped_objects_wait_for_the_render_thread(
    context: GraphicsContext,
) -> None:
    buffer = context.gl.buffer(reserve=16)
    del buffer
    gc.collect()
    assert context.gl.gc() == 1


def test_close_twice_and_then_nothing(open_headless: Open) -> None:
    context = open_headless()
    context.close()
    context.close()
    with pytest.raises(ContextError, match="closed"):
        context.function("glFinish", None)
    with pytest.raises(ContextError, match="closed"):
        context.make_current()


def test_nothing_keeps_a_closed_context(open_headless: Open) -> None:
    context = open_headless(debug=True)
    native: weakref.ref[NativeContext] = weakref.ref(context._native)
    context.close()
    del context
    gc.collect()
    assert native() is None


def test_contexts_come_and_go(open_headless: Open) -> None:
    for step in range(20):
        colour = (step / 20, 1.0, 0.0, 1.0)
        with open_headless() as context:
            assert_drawn(draw(context.gl, colour), colour)


def test_two_on_one_thread_take_turns(open_headless: Open) -> None:
    with open_headless() as first:
        first.release_current()
        with open_headless() as second:
            for step in range(3):
                colour = (step, 0.5, 0.25, 1.0)
                second.release_current()
                first.make_current()
                assert_drawn(draw(first.gl, colour), colour)
                first.release_current()
                second.make_current()
                assert_drawn(draw(second.gl, colour[::-1]), colour[::-1])
        first.make_current()
        assert_drawn(draw(first.gl, (1.0,) * 4), (1.0,) * 4)


def test_a_context_moves_between_threads(open_headless: Open) -> None:
    colour = (0.5, 0.25, 0.125, 1.0)
    with ThreadPoolExecutor(1) as thread:
        context = thread.submit(open_headless).result()
        with pytest.raises(ContextError, match="release it there first"):
            context.make_current()
        with pytest.raises(ContextError, match="release it there first"):
            context.close()
        thread.submit(context.release_current).result()
        context.make_current()
        assert_drawn(draw(context.gl, colour), colour)
        context.release_current()
        thread.submit(context.make_current).result()
        pixels = thread.submit(draw, context.gl, colour).result()
        assert_drawn(pixels, colour)
        thread.submit(context.close).result()


def test_the_context_of_a_dead_thread_is_closed(open_headless: Open) -> None:
    """Drivers may keep it bound to that thread, but nothing may hang."""
    kept: list[GraphicsContext] = []
    thread = threading.Thread(
        target=lambda: kept.append(open_headless(debug=True))
    )
    thread.start()
    thread.join()
    kept.pop().close()
    with open_headless() as context:
        assert_drawn(draw(context.gl, (1.0, 0.0, 0.0, 1.0)), (1, 0, 0, 1))


@pytest.mark.parametrize(
    "backends", [("egl", "egl"), ("egl", "osmesa"), ("osmesa", "osmesa")]
)
def test_two_threads_draw_side_by_side(backends: tuple[str, str]) -> None:
    openers = [_opener(backend) for backend in backends]
    for opener in openers:
        opener().close()
    turn = threading.Barrier(2, timeout=30)

    def work(index: int) -> None:
        with openers[index](debug=True) as context:
            for step in range(10):
                colour = (float(index), step / 10, 1.0 - index, 1.0)
                turn.wait()
                assert_drawn(draw(context.gl, colour), colour)
            context.gl.gc()
            assert context.drain_debug_messages() == []

    with ThreadPoolExecutor(2) as threads:
        list(threads.map(work, range(2)))


def test_every_device_can_be_chosen() -> None:
    devices = egl.list_devices()
    if not devices:
        pytest.skip("no driver lists a device")
    for device in devices:
        with open_context("egl", device=device.index) as context:
            assert context.label == f"EGL device {device.name}"


def test_a_device_that_is_not_there() -> None:
    with pytest.raises(ContextError, match="there is no device 99") as info:
        open_context(device=99)
    assert "OSMesa" not in str(info.value)


def test_a_native_context_dies_with_its_wrapper(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A version that ModernGL refuses must not leak the context."""
    destroyed: list[NativeContext] = []
    destroy = egl.EglContext.destroy

    def record(self: egl.EglContext) -> None:
        destroyed.append(self)
        destroy(self)

    def refuse(**_: object) -> None:
        raise ValueError("Requested OpenGL version 330, got version 210")

    monkeypatch.setattr(egl.EglContext, "destroy", record)
    monkeypatch.setattr(moderngl, "create_context", refuse)
    with pytest.raises(ContextError, match="got version 210"):
        candidates("egl")[1].open()
    assert len(destroyed) == 1


@pytest.mark.window
@pytest.mark.usefixtures("display")
def test_a_hidden_window_draws() -> None:
    colour = (0.5, 1.0, 0.25, 1.0)
    with open_context("window", debug=True) as context:
        assert context.label == "hidden window"
        context.release_current()
        context.make_current()
        assert_drawn(draw(context.gl, colour), colour)
        assert context.drain_debug_messages() == []


@pytest.mark.window
@pytest.mark.usefixtures("display")
def test_a_hidden_window_beside_egl() -> None:
    with open_context("egl") as first:
        first.release_current()
        with open_context("window") as second:
            assert_drawn(draw(second.gl, (1.0,) * 4), (1.0,) * 4)
        first.make_current()
        assert_drawn(draw(first.gl, (0.5,) * 4), (0.5,) * 4)
