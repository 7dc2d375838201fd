"""Generational handles: names of resources that outlive nothing.

A handle is a small value that any thread can hold, compare and put into a
sort key. Its generation tells a destroyed resource from the one that took
over its slot, so that use after destroy is an error and never a wrong
picture.
"""

import threading
from enum import IntEnum

from msgspec import Struct

from moka.core.errors import CommandError

__all__ = ["Handle", "HandleAllocator", "ResourceKind"]


class ResourceKind(IntEnum):
    """What a handle names."""

    BUFFER = 1
    TEXTURE = 2
    PROGRAM = 3
    MESH = 4
    FRAMEBUFFER = 5
    BIND_GROUP = 6


class Handle(Struct, frozen=True):
    """Names one resource of one device.

    ``index`` is the slot (reused after destroy), ``generation`` how often
    the slot was given out before, ``device`` the device's own number.
    """

    kind: ResourceKind
    index: int
    generation: int
    device: int

    def __str__(self) -> str:
        return f"{self.kind.name.lower()} {self.index}.{self.generation}"


class HandleAllocator:
    """Gives out and takes back the handles of one device; thread-safe."""

    def __init__(self, device: int) -> None:
        self._device = device
        self._lock = threading.Lock()
        self._generations: dict[ResourceKind, list[int]] = {
            kind: [] for kind in ResourceKind
        }
        self._alive: dict[ResourceKind, list[bool]] = {
            kind: [] for kind in ResourceKind
        }
        self._free: dict[ResourceKind, list[int]] = {
            kind: [] for kind in ResourceKind
        }

    def allocate(self, kind: ResourceKind) -> Handle:
        """A fresh handle of ``kind``."""
        with self._lock:
            if self._free[kind]:
                index = self._free[kind].pop()
                self._generations[kind][index] += 1
                self._alive[kind][index] = True
            else:
                index = len(self._generations[kind])
                self._generations[kind].append(0)
                self._alive[kind].append(True)
            generation = self._generations[kind][index]
        return Handle(kind, index, generation, self._device)

    def release(self, handle: Handle) -> None:
        """Take ``handle`` back; raises CommandError if it is not alive."""
        self.check(handle)
        with self._lock:
            self._alive[handle.kind][handle.index] = False
            self._free[handle.kind].append(handle.index)

    def is_alive(self, handle: Handle) -> bool:
        """Whether ``handle`` still names a resource of this device."""
        generations = self._generations[handle.kind]
        return (
            handle.device == self._device
            and handle.index < len(generations)
            and generations[handle.index] == handle.generation
            and self._alive[handle.kind][handle.index]
        )

    def check(self, handle: Handle, kind: ResourceKind | None = None) -> None:
        """Raise CommandError unless ``handle`` is alive and of ``kind``."""
        if kind is not None and handle.kind is not kind:
            raise CommandError(
                f"{handle}: expected a {kind.name.lower()} handle"
            )
        if handle.device != self._device:
            raise CommandError(
                f"{handle}: belongs to device {handle.device}, "
                f"not to device {self._device}"
            )
        if not self.is_alive(handle):
            raise CommandError(f"{handle}: used after it was destroyed")

    def count(self, kind: ResourceKind) -> int:
        """How many handles of ``kind`` are alive."""
        return sum(self._alive[kind])
