"""The lookup table of programs that are already loaded.

Keyed by whatever describes a program completely (a permutation, a name),
not by a hash of it: two descriptions can never share a program by accident.
"""

from collections.abc import Callable, Hashable

from moka.commands.descriptors import ProgramDescriptor
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = ["ProgramCache"]


class ProgramCache:
    """Programs of one device by their descriptions."""

    def __init__(self, device: GraphicsDevice) -> None:
        self._device = device
        self._programs: dict[Hashable, Handle] = {}

    def __len__(self) -> int:
        return len(self._programs)

    def get(
        self, key: Hashable, describe: Callable[[], ProgramDescriptor]
    ) -> Handle:
        """The program for ``key``; ``describe`` is asked for a new one."""
        handle = self._programs.get(key)
        if handle is None:
            handle = self._device.create_program(describe())
            self._programs[key] = handle
        return handle

    def clear(self) -> None:
        """Destroy all of them."""
        self._device.destroy(*self._programs.values())
        self._programs.clear()
