"""OpenGL without a window through EGL: on a device, or surfaceless.

Follows EGL 1.5 with EGL_EXT_device_enumeration, EGL_EXT_platform_device,
EGL_MESA_platform_surfaceless and EGL_KHR_surfaceless_context: everything is
drawn into framebuffer objects, so no surface is ever made.

All calls go through ``ctypes``, which releases the interpreter lock: loading
the driver takes tens of milliseconds in which other threads can decode.
"""

import ctypes
import os
from ctypes import POINTER, byref, c_char_p, c_int, c_uint, c_void_p
from functools import cache
from typing import Any

from msgspec import Struct

from moka.backend.contexts.native import NativeContext, bind, load_library
from moka.core.errors import ContextError

__all__ = [
    "EglContext",
    "EglDevice",
    "list_devices",
    "open_surfaceless",
    "release_thread",
]

_NONE = 0x3038
_EXTENSIONS = 0x3055
_SURFACE_TYPE = 0x3033
_RENDERABLE_TYPE = 0x3040
_OPENGL_BIT = 0x0008
_OPENGL_API = 0x30A2
_CONTEXT_MAJOR_VERSION = 0x3098
_CONTEXT_MINOR_VERSION = 0x30FB
_CONTEXT_OPENGL_PROFILE_MASK = 0x30FD
_CONTEXT_OPENGL_CORE_PROFILE_BIT = 0x0001
_CONTEXT_OPENGL_DEBUG = 0x31B0
_PLATFORM_DEVICE = 0x313F
_PLATFORM_SURFACELESS = 0x31DD
_DRM_DEVICE_FILE = 0x3233

_ERRORS = {
    0x3000: "no error code",
    0x3001: "EGL_NOT_INITIALIZED",
    0x3002: "EGL_BAD_ACCESS",
    0x3003: "EGL_BAD_ALLOC",
    0x3004: "EGL_BAD_ATTRIBUTE",
    0x3005: "EGL_BAD_CONFIG",
    0x3006: "EGL_BAD_CONTEXT",
    0x3008: "EGL_BAD_DISPLAY",
    0x3009: "EGL_BAD_MATCH",
    0x300C: "EGL_BAD_PARAMETER",
    0x300E: "EGL_CONTEXT_LOST",
}


def release_thread() -> None:
    """Let go of the EGL context that is current on this thread, if any is.

    Also of one that somebody else has made, or destroyed while it was
    current. While a thread has one, GLX does not notice what it makes
    current there, and ends the process when another thread takes that.
    """
    is_loaded = getattr(os, "RTLD_NOLOAD", None)
    if is_loaded is None:
        return
    try:
        library = ctypes.CDLL("libEGL.so.1", mode=is_loaded)
    except OSError:
        return  # Nobody in this process has used it.
    bind(library, "eglReleaseThread", c_uint)()


class _Library:
    """The functions of libEGL that a context without a surface needs."""

    def __init__(self) -> None:
        library = load_library("libEGL.so.1", "libEGL.so")
        pointer = c_void_p
        integers = POINTER(c_int)
        self.get_error = bind(library, "eglGetError", c_int)
        self.query_string = bind(
            library, "eglQueryString", c_char_p, pointer, c_int
        )
        self.get_proc_address = bind(
            library, "eglGetProcAddress", pointer, c_char_p
        )
        self.initialize = bind(
            library, "eglInitialize", c_uint, pointer, integers, integers
        )
        self.bind_api = bind(library, "eglBindAPI", c_uint, c_uint)
        self.choose_config = bind(
            library,
            "eglChooseConfig",
            c_uint,
            pointer,
            integers,
            POINTER(pointer),
            c_int,
            integers,
        )
        self.create_context = bind(
            library,
            "eglCreateContext",
            pointer,
            pointer,
            pointer,
            pointer,
            integers,
        )
        self.destroy_context = bind(
            library, "eglDestroyContext", c_uint, pointer, pointer
        )
        self.make_current = bind(
            library,
            "eglMakeCurrent",
            c_uint,
            pointer,
            pointer,
            pointer,
            pointer,
        )
        self.get_current_context = bind(
            library, "eglGetCurrentContext", pointer
        )
        self.client_extensions = self.extensions(None)

    def extensions(self, display: int | None) -> frozenset[str]:
        """Extensions of a display, or of the library itself for None."""
        text = self.query_string(display, _EXTENSIONS) or b""
        return frozenset(text.decode("ascii", "replace").split())

    def extension_function(
        self, name: str, result: Any, *arguments: Any
    ) -> Any:
        """A function that the library may not export; ContextError then."""
        address = self.get_proc_address(name.encode())
        if not address:
            raise ContextError(f"this EGL has no {name}")
        return ctypes.CFUNCTYPE(result, *arguments)(address)

    def platform_display(self, platform: int, native: int | None) -> int | None:
        """The display of a device, or of no device at all."""
        get = self.extension_function(
            "eglGetPlatformDisplayEXT", c_void_p, c_uint, c_void_p, c_void_p
        )
        display: int | None = get(platform, native, None)
        return display

    def failure(self, call: str) -> ContextError:
        """The error of the call that has just failed on this thread."""
        code = self.get_error()
        return ContextError(
            f"{call} failed: {_ERRORS.get(code, f'EGL error {code:#06x}')}"
        )


@cache
def _library() -> _Library:
    return _Library()


class EglDevice(Struct, frozen=True):
    """A device that EGL can draw with.

    ``index`` is its place in the order in which the drivers list them,
    ``pointer`` the EGLDeviceEXT.
    """

    index: int
    pointer: int
    is_software: bool
    file: str

    @property
    def name(self) -> str:
        """What a person reads: the number and what is behind it."""
        kind = self.file or ("software" if self.is_software else "")
        return f"{self.index} ({kind})" if kind else str(self.index)

    def open(self, *, debug: bool = False) -> "EglContext":
        """A context on this device; ContextError says why there is none."""
        egl = _library()
        display = egl.platform_display(_PLATFORM_DEVICE, self.pointer)
        label = f"EGL device {self.name}"
        return EglContext(display, label, debug=debug)


def list_devices() -> list[EglDevice]:
    """The devices of all installed drivers, in the drivers' order.

    Raises ContextError without libEGL or if it cannot list devices.
    """
    egl = _library()
    query = egl.extension_function(
        "eglQueryDevicesEXT",
        c_uint,
        c_int,
        POINTER(c_void_p),
        POINTER(c_int),
    )
    count = c_int()
    if not query(0, None, byref(count)):
        raise egl.failure("eglQueryDevicesEXT")
    pointers = (c_void_p * count.value)()
    if not query(count.value, pointers, byref(count)):
        raise egl.failure("eglQueryDevicesEXT")
    return [
        _describe(egl, index, pointer)
        for index, pointer in enumerate(pointers[: count.value])
        if pointer
    ]


def _describe(egl: _Library, index: int, pointer: int) -> EglDevice:
    """A device with what the optional EGL_EXT_device_query tells of it."""
    if "EGL_EXT_device_query" not in egl.client_extensions:
        return EglDevice(index, pointer, is_software=False, file="")
    query = egl.extension_function(
        "eglQueryDeviceStringEXT", c_char_p, c_void_p, c_int
    )
    extensions = (query(pointer, _EXTENSIONS) or b"").split()
    file = b""
    if b"EGL_EXT_device_drm" in extensions:
        file = query(pointer, _DRM_DEVICE_FILE) or b""
    return EglDevice(
        index,
        pointer,
        is_software=b"EGL_MESA_device_software" in extensions,
        file=file.decode("utf-8", "replace"),
    )


def open_surfaceless(*, debug: bool = False) -> "EglContext":
    """A context of Mesa's platform that needs no device to be listed."""
    egl = _library()
    if "EGL_MESA_platform_surfaceless" not in egl.client_extensions:
        raise ContextError("this EGL has no EGL_MESA_platform_surfaceless")
    display = egl.platform_display(_PLATFORM_SURFACELESS, None)
    return EglContext(display, "EGL surfaceless", debug=debug)


class EglContext(NativeContext):
    """A core context of OpenGL 3.3 or whatever later the driver offers.

    The display is shared by all contexts of a device in this process, so it
    stays initialised; EGL frees it when the process ends.
    """

    kind = "egl"

    def __init__(
        self, display: int | None, label: str, *, debug: bool = False
    ) -> None:
        self.label = label
        self._egl = egl = _library()
        self._context: int | None = None
        if not display:
            raise egl.failure("eglGetPlatformDisplayEXT")
        self._display = display
        if not egl.initialize(display, None, None):
            raise egl.failure("eglInitialize")
        if "EGL_KHR_surfaceless_context" not in egl.extensions(display):
            raise ContextError("no EGL_KHR_surfaceless_context")
        if not egl.bind_api(_OPENGL_API):
            raise egl.failure("eglBindAPI(EGL_OPENGL_API)")
        self._context = self._create(self._config(), debug=debug)
        try:
            self.make_current()
        except ContextError:
            self.destroy()
            raise

    def _config(self) -> int:
        """Any configuration for desktop OpenGL: no surface will use it."""
        attributes = (c_int * 5)(
            *(_SURFACE_TYPE, 0, _RENDERABLE_TYPE, _OPENGL_BIT, _NONE)
        )
        config, count = c_void_p(), c_int()
        chosen = self._egl.choose_config(
            self._display, attributes, byref(config), 1, byref(count)
        )
        if not chosen:
            raise self._egl.failure("eglChooseConfig")
        if not count.value or config.value is None:
            raise ContextError("the driver has no desktop OpenGL")
        return config.value

    def _create(self, config: int, *, debug: bool) -> int:
        attributes = [
            *(_CONTEXT_MAJOR_VERSION, 3, _CONTEXT_MINOR_VERSION, 3),
            *(_CONTEXT_OPENGL_PROFILE_MASK, _CONTEXT_OPENGL_CORE_PROFILE_BIT),
        ]
        if debug:
            attributes += [_CONTEXT_OPENGL_DEBUG, 1]
        attributes.append(_NONE)
        context: int | None = self._egl.create_context(
            self._display,
            config,
            None,
            (c_int * len(attributes))(*attributes),
        )
        if not context:
            raise self._egl.failure("eglCreateContext for OpenGL 3.3 core")
        return context

    def make_current(self) -> None:
        egl = self._egl
        egl.bind_api(_OPENGL_API)
        if not egl.make_current(self._display, None, None, self._context):
            raise egl.failure("eglMakeCurrent")

    def release_current(self) -> None:
        self._egl.bind_api(_OPENGL_API)
        self._egl.make_current(self._display, None, None, None)

    def destroy(self) -> None:
        if self._context is None:
            return
        context, self._context = self._context, None
        self._egl.bind_api(_OPENGL_API)
        if self._egl.get_current_context() == context:
            self.release_current()
        self._egl.destroy_context(self._display, context)

    def load_opengl_function(self, name: str) -> int:
        return self._egl.get_proc_address(name.encode()) or 0
