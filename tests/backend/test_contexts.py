"""Choosing a context, and saying why there is none; without a GPU."""

import ctypes
from collections.abc import Callable
from typing import Any

import pytest

from moka.backend.contexts import (
    BACKENDS,
    DebugMessage,
    Severity,
    candidates,
    open_context,
    selection,
)
from moka.backend.contexts.debug import DebugLog
from moka.backend.contexts.native import bind, load_library
from moka.core.errors import ContextError, OptionError

CREATORS = ("_egl_device", "_surfaceless", "_osmesa", "_hidden")
ORDER = ["EGL device", "EGL surfaceless", "OSMesa", "hidden window"]


@pytest.fixture
def no_context(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that could be tried works."""
    for name in CREATORS:

        def fail(*_: object, name: str = name) -> None:
            raise ContextError(f"cause of {name}")

        monkeypatch.setattr(selection, name, fail)


def test_auto_tries_all_in_order() -> None:
    assert [each.label for each in candidates()] == ORDER


@pytest.mark.parametrize(
    "backend", [name for name in BACKENDS if name != "auto"]
)
def test_a_backend_tries_nothing_else(backend: str) -> None:
    tried = candidates(backend)
    assert tried
    assert {each.backend for each in tried} == {backend}


@pytest.mark.parametrize("backend", ["auto", "egl"])
def test_a_device_is_tried_alone(backend: str) -> None:
    tried = candidates(backend, device=1)
    assert [each.label for each in tried] == ["EGL device"]


@pytest.mark.parametrize("backend", ["", "glx", "EGL", "none"])
def test_an_unknown_backend_is_named(backend: str) -> None:
    with pytest.raises(OptionError, match="auto, egl, osmesa, window") as info:
        candidates(backend)
    assert repr(backend) in str(info.value)


@pytest.mark.parametrize(
    ("backend", "device"), [("osmesa", 0), ("window", 1), ("egl", -1)]
)
def test_a_device_needs_egl(backend: str, device: int) -> None:
    with pytest.raises(OptionError, match=f"device {device} with"):
        open_context(backend, device=device)


@pytest.mark.usefixtures("no_context")
def test_the_error_lists_everything_that_was_tried() -> None:
    with pytest.raises(ContextError) as info:
        open_context()
    message = str(info.value)
    assert "\n" not in message
    places = [message.index(f"{label}: ") for label in ORDER]
    assert places == sorted(places)
    for name in CREATORS:
        assert f"cause of {name}" in message


@pytest.mark.usefixtures("no_context")
def test_every_attempt_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("INFO", "moka"), pytest.raises(ContextError):
        open_context()
    assert [record.name for record in caplog.records] == [
        selection.__name__
    ] * len(ORDER)
    for label, message in zip(ORDER, caplog.messages, strict=True):
        assert message.startswith(f"no context: {label}: cause of ")


@pytest.mark.parametrize(
    ("platform", "hint"),
    [
        ("linux", "libegl1, libegl-mesa0 and libgl1-mesa-dri"),
        ("linux", "libosmesa6"),
        ("linux", "xvfb-run"),
        ("darwin", "macOS has no EGL"),
        ("win32", "osmesa.dll"),
    ],
)
@pytest.mark.usefixtures("no_context")
def test_the_error_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, platform: str, hint: str
) -> None:
    monkeypatch.setattr(selection.sys, "platform", platform)
    with pytest.raises(ContextError) as info:
        open_context()
    assert hint in str(info.value)


def test_a_missing_display_is_the_cause(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(selection.sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ContextError, match="DISPLAY is not set"):
        open_context("window")


def test_a_missing_library_names_the_first_choice() -> None:
    with pytest.raises(ContextError, match="libnowhere-1"):
        load_library("libnowhere-1.so", "libnowhere-2.so")


def test_a_missing_function_names_its_library() -> None:
    with pytest.raises(ContextError, match="has no moka_nothing"):
        bind(ctypes.CDLL(None), "moka_nothing", None)


class FakeGL:
    """OpenGL functions by name that record how they are called."""

    def __init__(self, errors: list[int] | None = None) -> None:
        self.calls: list[tuple[str, tuple[Any, ...]]] = []
        self.errors = errors or []

    def __call__(self, name: str, *_: object) -> Callable[..., Any]:
        def call(*arguments: Any) -> int:
            self.calls.append((name, arguments))
            if name == "glGetError" and self.errors:
                return self.errors.pop(0)
            return 0

        return call

    def report(self, kind: int, severity: int, text: bytes | None) -> None:
        """What a driver does when it has something to say."""
        (callback, _) = next(
            arguments
            for name, arguments in self.calls
            if name == "glDebugMessageCallback"
        )
        callback(0x8246, kind, 7, severity, len(text or b""), text, None)


def test_messages_are_drained_once_and_in_order() -> None:
    gl = FakeGL()
    log = DebugLog(gl, has_debug_output=True)
    gl.report(0x824C, 0x9146, b"invalid enum\n")
    gl.report(0x8250, 0x9147, b"slow path")
    gl.report(0x824E, 0x9148, None)
    assert log.drain() == [
        DebugMessage(Severity.HIGH, 7, "invalid enum", is_error=True),
        DebugMessage(Severity.MEDIUM, 7, "slow path", is_error=False),
        DebugMessage(Severity.LOW, 7, "", is_error=True),
    ]
    assert log.drain() == []


def test_notifications_are_left_out() -> None:
    gl = FakeGL()
    log = DebugLog(gl, has_debug_output=True)
    gl.report(0x8251, 0x826B, b"buffer will use video memory")
    assert log.drain() == []


def test_undrained_messages_do_not_grow_without_bound() -> None:
    gl = FakeGL()
    log = DebugLog(gl, has_debug_output=True)
    for _ in range(3000):
        gl.report(0x824C, 0x9146, b"again")
    assert len(log.drain()) == 1000


def test_a_stopped_log_leaves_no_callback_behind() -> None:
    gl = FakeGL()
    log = DebugLog(gl, has_debug_output=True)
    log.stop()
    name, (callback, _) = gl.calls[-1]
    assert name == "glDebugMessageCallback"
    assert not callback


def test_without_debug_output_errors_are_polled() -> None:
    gl = FakeGL([0x0502, 0x0505, 0x1234])
    log = DebugLog(gl, has_debug_output=False)
    assert {name for name, _ in gl.calls} == set()
    assert [str(message) for message in log.drain()] == [
        "GL_INVALID_OPERATION",
        "GL_OUT_OF_MEMORY",
        "GL error 0x1234",
    ]
    assert log.drain() == []


def test_a_context_that_only_errs_does_not_hang() -> None:
    gl = FakeGL([0x0507] * 100)
    log = DebugLog(gl, has_debug_output=False)
    assert len(log.drain()) == 16
