"""The rare commands: small frozen values that set up and end passes.

Draws are not here. A frame holds a dozen of these and thousands of draws,
so draws are rows of arrays (:mod:`moka.commands.draws`).

Rectangles are in pixels from the lower left corner, as GL counts them.
"""

from concurrent.futures import Future
from itertools import pairwise
from typing import Any, TypeAlias

from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.handles import Handle

__all__ = [
    "BindFramebuffer",
    "Clear",
    "Command",
    "FillBuffer",
    "FillTexture",
    "GenerateMipmaps",
    "ReadPixels",
    "Readback",
    "ResolveFramebuffer",
    "SetScissor",
    "SetViewport",
    "Timestamp",
    "Timestamps",
]


class BindFramebuffer(Struct, frozen=True):
    """Draw into ``framebuffer``; None is the window.

    Also ends the scissor and sets the viewport to the whole of it; a window
    changes its size on another thread, so there the viewport is yours.
    """

    framebuffer: Handle | None


class Clear(Struct, frozen=True):
    """Clear what is given: linear RGBA colour, depth, or both."""

    colour: tuple[float, float, float, float] | None = None
    depth: float | None = None


class SetViewport(Struct, frozen=True):
    """Map clip space to this rectangle (x, y, width, height)."""

    rectangle: tuple[int, int, int, int]


class SetScissor(Struct, frozen=True):
    """Draw and clear only inside this rectangle; None is everywhere."""

    rectangle: tuple[int, int, int, int] | None


class FillBuffer(Struct, frozen=True):
    """Write ``data`` into ``buffer`` at ``offset``; copied when recorded."""

    buffer: Handle
    data: bytes
    offset: int = 0


class FillTexture(Struct, frozen=True):
    """Write texels, from number ``first`` on, of a buffer texture.

    ``data`` holds them in the texture's own format.
    """

    texture: Handle
    data: bytes
    first: int = 0


class GenerateMipmaps(Struct, frozen=True):
    """Make the lower mip levels of ``texture`` from level 0."""

    texture: Handle


class ResolveFramebuffer(Struct, frozen=True):
    """Average the samples of ``source`` into ``target`` of equal size.

    Of one sample this is a copy.
    """

    source: Handle
    target: Handle


class Readback:
    """Where the texels of a :class:`ReadPixels` arrive.

    ``arrived`` is done when they have: an array (height, width, channels)
    with the bottom row first. That is so when the frame that holds the
    command has been waited for, or the one after it has been executed.
    """

    __slots__ = ("arrived",)

    def __init__(self) -> None:
        self.arrived: Future[NDArray[Any]] = Future()

    @property
    def data(self) -> NDArray[Any] | None:
        """The texels; None as long as they have not arrived.

        Raises what kept them from arriving.
        """
        return self.arrived.result() if self.arrived.done() else None


class ReadPixels(Struct, frozen=True):
    """Read one colour attachment of a framebuffer, bottom row first.

    ``dtype`` is ``f4`` for float32 texels or ``u1`` for bytes; rows are
    packed without padding.
    """

    framebuffer: Handle | None
    rectangle: tuple[int, int, int, int]
    into: Readback
    attachment: int = 0
    channels: int = 4
    dtype: str = "f4"


class Timestamps:
    """Where the times of the :class:`Timestamp` of one recording arrive.

    The render thread writes ``marks``, labels and nanoseconds in the order
    of the commands, some frames later and without waiting for the GPU. None
    until then, and for ever where the GPU has no clock.
    """

    __slots__ = ("marks",)

    def __init__(self) -> None:
        self.marks: list[tuple[str, int]] | None = None

    @property
    def seconds(self) -> dict[str, float] | None:
        """By label, the time from each mark to the next, in seconds.

        Marks of one label add up; the last one only ends what is before it.
        """
        if self.marks is None:
            return None
        spent: dict[str, float] = {}
        for (label, begin), (_, end) in pairwise(self.marks):
            spent[label] = spent.get(label, 0.0) + 1e-9 * (end - begin)
        return spent


class Timestamp(Struct, frozen=True):
    """Note when the GPU has done all that was asked of it before."""

    label: str
    into: Timestamps


Command: TypeAlias = (
    BindFramebuffer
    | Clear
    | SetViewport
    | SetScissor
    | FillBuffer
    | FillTexture
    | GenerateMipmaps
    | ResolveFramebuffer
    | ReadPixels
    | Timestamp
)
