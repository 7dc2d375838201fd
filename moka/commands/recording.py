"""What a finished command list is: a value that backends execute."""

from msgspec import Struct

from moka.commands.commands import Command
from moka.commands.descriptors import RasterState
from moka.commands.draws import Draws, Instances
from moka.commands.handles import Handle

__all__ = ["DrawSpan", "Recording"]


class DrawSpan(Struct, frozen=True):
    """Rows ``start`` to ``stop`` of a recording's draws."""

    start: int
    stop: int


class Recording(Struct, frozen=True):
    """A finished command list, as a backend executes it.

    ``steps`` is the frame in order: rare commands and spans of ``draws``.
    The rows of ``instances`` stand in the order of the draws that use them,
    so that the whole array reaches the GPU in one write and neighbours can
    be merged. ``handles`` are sets of the resources that it uses.
    """

    steps: tuple[Command | DrawSpan, ...]
    draws: Draws
    instances: Instances
    states: tuple[RasterState, ...]
    handles: tuple[frozenset[Handle], ...]
