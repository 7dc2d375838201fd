"""A device on a driver that has nothing beyond OpenGL 3.3."""

from moka.backend.contexts import open_context
from moka.backend.moderngl_backend import ModernGLBackend
from moka.graphics.device import GraphicsDevice
from moka.graphics.shader_source import explain_log

__all__ = ["open_plain_device"]


def open_plain_device(**absent: bool) -> GraphicsDevice:
    """A debug device on EGL whose driver seems to lack newer features.

    ``absent`` are the switches of ModernGLBackend, all False by default.
    """
    switches = {"multi_draw": False, "clip_control": False} | absent

    def open_backend() -> ModernGLBackend:
        context = open_context("egl", debug=True)
        return ModernGLBackend(context, explain_log, **switches)

    return GraphicsDevice(open_backend)
