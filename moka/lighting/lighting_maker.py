"""Lighting of an environment: from the cache, or made now."""

from typing import TYPE_CHECKING

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.disk_cache import DiskCache
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.lighting_cache import LightingCache

if TYPE_CHECKING:
    from moka.lighting.preintegration_passes import Told

__all__ = ["LightingMaker"]


class LightingMaker:
    """Makes lighting on one device, and loads BRDF tables, each only once.

    ``cache`` is where results of earlier runs are found and new ones go;
    None for none.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        cache: DiskCache | None = None,
    ) -> None:
        self._device = device
        self._passes = passes
        self._cache = LightingCache(device, cache)
        self._tables: dict[str, Handle] = {}

    def make(
        self, request: LightingRequest, told: "Told | None" = None
    ) -> EnvironmentLighting:
        """What ``request`` asks for, to be filled and destroyed by the caller.

        ``told`` is make_lighting's.
        """
        lighting = self._cache.load(request)
        if lighting is None:
            # What is found does not import what would have made it.
            from moka.lighting.make_lighting import make_lighting

            lighting = make_lighting(self._device, self._passes, request, told)
            self._cache.keep(request, lighting)
        elif request.background:
            pixels = request.environment.pixels
            if request.environment.suns:
                from moka.lighting.suns import full_map

                pixels = full_map(request.environment, request.most_suns)
            lighting.maps.add_map(self._device, pixels)
        return lighting

    def table(self, brdf: str) -> Handle:
        """The BRDF table of ``brdf``; see moka.lighting.brdf_table."""
        if brdf not in self._tables:
            from moka.lighting.brdf_table import load_brdf_table

            self._tables[brdf] = load_brdf_table(self._device, brdf)
        return self._tables[brdf]

    @property
    def has_something_to_keep(self) -> bool:
        """Whether :meth:`keep` would write anything."""
        return self._cache.is_pending

    def keep(self) -> None:
        """Write what is new to the cache; waits for the GPU and the disk.

        To be called before what has been made is destroyed.
        """
        self._cache.flush()
