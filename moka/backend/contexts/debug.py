"""What the driver has to say: KHR_debug messages, or plain GL errors.

The interface is that of OpenGL 4.3 and KHR_debug; drivers that have neither
(macOS) are asked with ``glGetError`` whenever the messages are drained.
"""

import ctypes
from collections.abc import Callable
from ctypes import c_char_p, c_int, c_uint, c_void_p
from enum import Enum
from typing import Any

from msgspec import Struct

__all__ = ["DebugLog", "DebugMessage", "Severity"]

_DEBUG_OUTPUT = 0x92E0
_DEBUG_OUTPUT_SYNCHRONOUS = 0x8242
_DONT_CARE = 0x1100
_TYPE_ERROR = 0x824C
_TYPE_UNDEFINED_BEHAVIOUR = 0x824E
_SEVERITY_NOTIFICATION = 0x826B

_GL_ERRORS = {
    0x0500: "GL_INVALID_ENUM",
    0x0501: "GL_INVALID_VALUE",
    0x0502: "GL_INVALID_OPERATION",
    0x0503: "GL_STACK_OVERFLOW",
    0x0504: "GL_STACK_UNDERFLOW",
    0x0505: "GL_OUT_OF_MEMORY",
    0x0506: "GL_INVALID_FRAMEBUFFER_OPERATION",
}
# A lost context may answer every glGetError with an error.
_MOST_ERRORS = 16
# So that a run that nobody drains does not grow without bound.
_MOST_MESSAGES = 1000

_Callback = ctypes.CFUNCTYPE(
    None, c_uint, c_uint, c_uint, c_uint, c_int, c_char_p, c_void_p
)


class Severity(Enum):
    """How much a message matters; the values are those of OpenGL."""

    HIGH = 0x9146
    MEDIUM = 0x9147
    LOW = 0x9148


class DebugMessage(Struct, frozen=True):
    """One message; ``is_error`` for GL errors and undefined behaviour."""

    severity: Severity
    id: int
    text: str
    is_error: bool

    def __str__(self) -> str:
        return self.text


class DebugLog:
    """Collects the messages of the context that is current on this thread.

    ``function`` gives OpenGL functions by name, ``has_debug_output`` tells
    whether the context has KHR_debug. Messages arrive on the thread and
    during the call that caused them; pure notifications are left out.
    """

    def __init__(
        self, function: Callable[..., Any], *, has_debug_output: bool
    ) -> None:
        self._messages: list[DebugMessage] = []
        # The driver holds a bare pointer: this keeps the callback alive.
        self._callback = _Callback(self._receive)
        self._set_callback: Callable[..., Any] | None = None
        self._get_error: Callable[..., Any] | None = None
        if not has_debug_output:
            self._get_error = function("glGetError", c_uint)
            return
        enable = function("glEnable", None, c_uint)
        enable(_DEBUG_OUTPUT)
        enable(_DEBUG_OUTPUT_SYNCHRONOUS)
        function(
            "glDebugMessageControl",
            None,
            *(c_uint, c_uint, c_uint, c_int, c_void_p, ctypes.c_ubyte),
        )(_DONT_CARE, _DONT_CARE, _SEVERITY_NOTIFICATION, 0, None, 0)
        self._set_callback = function(
            "glDebugMessageCallback", None, _Callback, c_void_p
        )
        self._set_callback(self._callback, None)

    def drain(self) -> list[DebugMessage]:
        """The messages since the last call, oldest first."""
        if self._get_error is not None:
            for _ in range(_MOST_ERRORS):
                code = self._get_error()
                if not code:
                    break
                text = _GL_ERRORS.get(code, f"GL error {code:#06x}")
                self._add(DebugMessage(Severity.HIGH, code, text, True))
        messages, self._messages = self._messages, []
        return messages

    def stop(self) -> None:
        """Let the driver forget the callback; the context is current."""
        if self._set_callback is not None:
            self._set_callback(_Callback(), None)

    def _add(self, message: DebugMessage) -> None:
        if len(self._messages) < _MOST_MESSAGES:
            self._messages.append(message)

    def _receive(
        self,
        source: int,  # noqa: ARG002
        kind: int,
        id: int,  # noqa: A002
        severity: int,
        length: int,  # noqa: ARG002
        text: bytes | None,
        user: int | None,  # noqa: ARG002
    ) -> None:
        if severity == _SEVERITY_NOTIFICATION:
            return
        self._add(
            DebugMessage(
                Severity(severity),
                id,
                (text or b"").decode("utf-8", "replace").strip(),
                kind in (_TYPE_ERROR, _TYPE_UNDEFINED_BEHAVIOUR),
            )
        )
