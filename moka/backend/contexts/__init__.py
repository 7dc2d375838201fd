"""OpenGL contexts: EGL, OSMesa, a hidden window, a visible one.

:func:`open_context` finds the first that works. Each window system is one
file that makes a :class:`NativeContext`; :class:`GraphicsContext` wraps it
for the backend. No library is loaded before it is tried.
"""

from moka.backend.contexts.context import GraphicsContext
from moka.backend.contexts.debug import DebugMessage, Severity
from moka.backend.contexts.native import NativeContext
from moka.backend.contexts.selection import (
    BACKENDS,
    Candidate,
    candidates,
    open_context,
)
from moka.backend.contexts.window import WindowContext

__all__ = [
    "BACKENDS",
    "Candidate",
    "DebugMessage",
    "GraphicsContext",
    "NativeContext",
    "Severity",
    "WindowContext",
    "candidates",
    "open_context",
]
