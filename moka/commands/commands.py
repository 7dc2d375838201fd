"""The rare commands: small frozen values that set up and end passes.

Draws are not here. A frame holds a dozen of these and thousands of draws,
so draws are rows of arrays (:mod:`moka.commands.draws`).

Rectangles are in pixels from the lower left corner, as GL counts them.
"""

from dataclasses import dataclass, field
from typing import Any, TypeAlias

from numpy.typing import NDArray

from moka.commands.handles import Handle

__all__ = [
    "BindFramebuffer",
    "Clear",
    "Command",
    "FillBuffer",
    "GenerateMipmaps",
    "ReadPixels",
    "Readback",
    "ResolveFramebuffer",
    "SetScissor",
    "SetViewport",
]


@dataclass(frozen=True, slots=True)
class BindFramebuffer:
    """Draw into ``framebuffer``; None is the window.

    Also ends the scissor and sets the viewport to the whole of it; a window
    changes its size on another thread, so there the viewport is yours.
    """

    framebuffer: Handle | None


@dataclass(frozen=True, slots=True)
class Clear:
    """Clear what is given: linear RGBA colour, depth, or both."""

    colour: tuple[float, float, float, float] | None = None
    depth: float | None = None


@dataclass(frozen=True, slots=True)
class SetViewport:
    """Map clip space to this rectangle (x, y, width, height)."""

    rectangle: tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class SetScissor:
    """Draw and clear only inside this rectangle; None is everywhere."""

    rectangle: tuple[int, int, int, int] | None


@dataclass(frozen=True, slots=True)
class FillBuffer:
    """Write ``data`` into ``buffer`` at ``offset``; copied when recorded."""

    buffer: Handle
    data: bytes = field(repr=False)
    offset: int = 0


@dataclass(frozen=True, slots=True)
class GenerateMipmaps:
    """Make the lower mip levels of ``texture`` from level 0."""

    texture: Handle


@dataclass(frozen=True, slots=True)
class ResolveFramebuffer:
    """Average the samples of ``source`` into ``target`` of equal size."""

    source: Handle
    target: Handle


class Readback:
    """Where the texels of a :class:`ReadPixels` arrive.

    The render thread writes ``data``, an array (height, width, channels)
    with the bottom row first; the caller reads it after the frame that holds
    the command has been waited for.
    """

    __slots__ = ("data",)

    def __init__(self) -> None:
        self.data: NDArray[Any] | None = None


@dataclass(frozen=True, slots=True)
class ReadPixels:
    """Read one colour attachment of a framebuffer, bottom row first.

    ``dtype`` is ``f4`` for float32 texels or ``u1`` for bytes; rows are
    packed without padding.
    """

    framebuffer: Handle | None
    rectangle: tuple[int, int, int, int]
    into: Readback = field(compare=False)
    attachment: int = 0
    channels: int = 4
    dtype: str = "f4"


Command: TypeAlias = (
    BindFramebuffer
    | Clear
    | SetViewport
    | SetScissor
    | FillBuffer
    | GenerateMipmaps
    | ResolveFramebuffer
    | ReadPixels
)
