"""OpenGL in software without EGL or a window, through Mesa's OSMesa.

For systems whose Mesa is older than 25.1, where OSMesa was removed. See
``GL/osmesa.h`` for the interface; calls release the interpreter lock.
"""

import ctypes
from ctypes import POINTER, c_char_p, c_int, c_uint, c_void_p
from functools import cache

from moka.backend.contexts.native import NativeContext, bind, load_library
from moka.core.errors import ContextError

__all__ = ["OSMesaContext"]

_FORMAT = 0x22
_RGBA = 0x1908
_PROFILE = 0x33
_CORE_PROFILE = 0x34
_CONTEXT_MAJOR_VERSION = 0x36
_CONTEXT_MINOR_VERSION = 0x37
_UNSIGNED_BYTE = 0x1401


class _Library:
    """The functions of libOSMesa."""

    def __init__(self) -> None:
        library = load_library(
            "libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so", "osmesa.dll"
        )
        self.create_context = bind(
            library,
            "OSMesaCreateContextAttribs",
            c_void_p,
            POINTER(c_int),
            c_void_p,
        )
        self.make_current = bind(
            library,
            "OSMesaMakeCurrent",
            ctypes.c_ubyte,
            *(c_void_p, c_void_p, c_uint, c_int, c_int),
        )
        self.get_current_context = bind(
            library, "OSMesaGetCurrentContext", c_void_p
        )
        self.destroy_context = bind(
            library, "OSMesaDestroyContext", None, c_void_p
        )
        self.get_proc_address = bind(
            library, "OSMesaGetProcAddress", c_void_p, c_char_p
        )


@cache
def _library() -> _Library:
    return _Library()


class OSMesaContext(NativeContext):
    """A core context of OpenGL 3.3 or later on the processor.

    OSMesa draws into memory of the caller; everything here is drawn into
    framebuffer objects, so that memory is a single pixel.
    """

    kind = "osmesa"
    label = "OSMesa"

    def __init__(self) -> None:
        self._osmesa = osmesa = _library()
        attributes = [
            *(_FORMAT, _RGBA, _PROFILE, _CORE_PROFILE),
            *(_CONTEXT_MAJOR_VERSION, 3, _CONTEXT_MINOR_VERSION, 3, 0),
        ]
        self._pixel = (ctypes.c_ubyte * 4)()
        self._context: int | None = osmesa.create_context(
            (c_int * len(attributes))(*attributes), None
        )
        if not self._context:
            raise ContextError("OSMesa makes no OpenGL 3.3 core context")
        try:
            self.make_current()
        except ContextError:
            self.destroy()
            raise

    def make_current(self) -> None:
        made = self._osmesa.make_current(
            self._context, self._pixel, _UNSIGNED_BYTE, 1, 1
        )
        if not made:
            raise ContextError("OSMesaMakeCurrent failed")

    def release_current(self) -> None:
        self._osmesa.make_current(None, None, _UNSIGNED_BYTE, 0, 0)

    def destroy(self) -> None:
        if self._context is None:
            return
        context, self._context = self._context, None
        if self._osmesa.get_current_context() == context:
            self.release_current()
        self._osmesa.destroy_context(context)

    def load_opengl_function(self, name: str) -> int:
        return self._osmesa.get_proc_address(name.encode()) or 0
