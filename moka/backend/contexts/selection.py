"""Which contexts to try, in which order, and what to say if none works."""

import logging
import sys
from collections.abc import Callable
from functools import partial

from msgspec import Struct

from moka.backend.contexts.context import GraphicsContext
from moka.backend.contexts.native import NativeContext
from moka.core.errors import ContextError, OptionError
from moka.core.log import get_logger

__all__ = ["BACKENDS", "Candidate", "candidates", "open_context"]

_LOGGER = get_logger(__name__)

BACKENDS = ("auto", "egl", "osmesa", "window")

_LINUX_HINTS = {
    "egl": "install libegl1, libegl-mesa0 and libgl1-mesa-dri",
    "osmesa": "install libosmesa6",
    "window": "install libgl1 and libx11-6, and run with a display, "
    "for instance under xvfb-run of the package xvfb",
}
_WINDOWS_HINTS = {
    "egl": "use the backend window: Windows has no EGL",
    "osmesa": "put osmesa.dll of a Mesa build for Windows on the PATH",
    "window": "install the driver of the graphics card",
}
_MACOS_HINTS = {
    "egl": "use the backend window: macOS has no EGL",
    "osmesa": "use the backend window: OSMesa is for Linux",
    "window": "log in to the desktop of this machine",
}


class Candidate(Struct, frozen=True):
    """A way to a context that has not been tried yet.

    ``create`` takes whether a debug context is wanted and raises
    ContextError with the cause; ``hint`` says what to do then.
    """

    backend: str
    label: str
    create: Callable[[bool], NativeContext]
    hint: str

    def open(self, *, debug: bool = False) -> GraphicsContext:
        """The context, current on this thread; ContextError if none."""
        return GraphicsContext(self.create(debug), debug=debug)


def candidates(
    backend: str = "auto", device: int | None = None
) -> list[Candidate]:
    """What :func:`open_context` tries, in its order.

    Raises OptionError for an unknown backend or a device without EGL.
    """
    if backend not in BACKENDS:
        raise OptionError(
            f"backend {backend!r} is unknown: choose one of "
            + ", ".join(BACKENDS)
        )
    if device is not None and (device < 0 or backend not in ("auto", "egl")):
        raise OptionError(
            f"device {device} with backend {backend}: a device is chosen "
            "for the backend egl, by its number from 0"
        )
    known = [
        Candidate(
            "egl", "EGL device", partial(_egl_device, device), _hint("egl")
        )
    ]
    if device is None:
        known += [
            Candidate("egl", "EGL surfaceless", _surfaceless, _hint("egl")),
            Candidate("osmesa", "OSMesa", _osmesa, _hint("osmesa")),
            Candidate("window", "hidden window", _hidden, _hint("window")),
        ]
    return [each for each in known if backend in ("auto", each.backend)]


def open_context(
    backend: str = "auto", *, device: int | None = None, debug: bool = False
) -> GraphicsContext:
    """A context of OpenGL 3.3 core or later, current on this thread.

    ``auto`` tries an EGL device (hardware before software), EGL surfaceless,
    OSMesa and a hidden window, in that order. ``device`` asks for one EGL
    device by its number and for nothing else. With ``debug`` the driver's
    messages are collected.

    Raises ContextError, which lists what was tried with each cause and what
    to install, and OptionError for an unknown backend.
    """
    causes = []
    for candidate in candidates(backend, device):
        try:
            context = candidate.open(debug=debug)
        except ContextError as error:
            cause = f"{candidate.label}: {error} ({candidate.hint})"
            _LOGGER.info("no context: %s", cause)
            causes.append(cause)
            continue
        if _LOGGER.isEnabledFor(logging.INFO):
            facts = context.describe()
            _LOGGER.info(
                "%s: %s, OpenGL %s",
                *(facts[name] for name in ("context", "renderer", "version")),
            )
        return context
    raise ContextError("no OpenGL 3.3 context: " + "; ".join(causes))


def _egl_device(device: int | None, debug: bool) -> NativeContext:
    """Device number ``device``, or the first that works."""
    from moka.backend.contexts import egl

    devices = egl.list_devices()
    if device is not None:
        if device >= len(devices):
            raise ContextError(
                f"there is no device {device}, only "
                + (", ".join(each.name for each in devices) or "none")
            )
        return devices[device].open(debug=debug)
    causes = []
    for each in sorted(devices, key=lambda device: device.is_software):
        try:
            return each.open(debug=debug)
        except ContextError as error:
            causes.append(f"{each.name}: {error}")
    raise ContextError(", ".join(causes) or "no driver lists a device")


def _surfaceless(debug: bool) -> NativeContext:
    from moka.backend.contexts import egl

    return egl.open_surfaceless(debug=debug)


def _osmesa(debug: bool) -> NativeContext:  # noqa: ARG001
    from moka.backend.contexts.osmesa import OSMesaContext

    return OSMesaContext()


def _hidden(debug: bool) -> NativeContext:  # noqa: ARG001
    from moka.backend.contexts.hidden import HiddenWindowContext

    return HiddenWindowContext()


def _hint(backend: str) -> str:
    if sys.platform == "win32":
        return _WINDOWS_HINTS[backend]
    if sys.platform == "darwin":
        return _MACOS_HINTS[backend]
    return _LINUX_HINTS[backend]
