"""The lookup table of programs that are already loaded.

Keyed by whatever describes a program completely (a permutation, a name),
not by a hash of it: two descriptions can never share a program by accident.
"""

from collections.abc import Callable, Hashable
from threading import Lock

from msgspec import Struct

from moka.commands.descriptors import ProgramDescriptor
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = ["ProgramCache"]

Describe = Callable[[], ProgramDescriptor]


class _Loaded(Struct):
    """A program, its sources, and who knows what they are now."""

    handle: Handle
    descriptor: ProgramDescriptor
    describe: Describe


class ProgramCache:
    """Programs of one device by their descriptions; thread-safe."""

    def __init__(self, device: GraphicsDevice) -> None:
        self._device = device
        self._programs: dict[Hashable, _Loaded] = {}
        self._lock = Lock()

    def __len__(self) -> int:
        return len(self._programs)

    def get(self, key: Hashable, describe: Describe) -> Handle:
        """The program for ``key``; ``describe`` is asked for a new one."""
        with self._lock:
            loaded = self._programs.get(key)
            if loaded is None:
                descriptor = describe()
                handle = self._device.create_program(descriptor)
                loaded = _Loaded(handle, descriptor, describe)
                self._programs[key] = loaded
            return loaded.handle

    def reload(self) -> int:
        """Compile what has other sources now; returns how many that are.

        All of them are replaced, and have other handles then, or, where one
        does not compile, none: raises ShaderError, and draws go on as before.
        Sources are remembered until
        :func:`moka.graphics.shader_source.forget_shaders`.
        """
        with self._lock:
            return self._reload()

    def _reload(self) -> int:
        changed = {
            key: descriptor
            for key, loaded in self._programs.items()
            if (descriptor := loaded.describe()) != loaded.descriptor
        }
        handles = self._device.create_programs(list(changed.values()))
        fresh = {
            key: _Loaded(handle, descriptor, self._programs[key].describe)
            for handle, (key, descriptor) in zip(
                handles, changed.items(), strict=True
            )
        }
        self._device.destroy(*(self._programs[key].handle for key in fresh))
        self._programs.update(fresh)
        return len(fresh)

    def clear(self) -> None:
        """Destroy all of them."""
        self._device.destroy(
            *(loaded.handle for loaded in self._programs.values())
        )
        self._programs.clear()
