"""Lighting of an environment: from the cache, or made now."""

import numpy as np
from numpy.typing import NDArray

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.brdf_table import make_brdf_table
from moka.lighting.disk_cache import DiskCache
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.lighting_cache import LightingCache
from moka.lighting.preintegration import Preintegrator
from moka.lighting.spherical_harmonics import (
    irradiance_error,
    irradiance_harmonics,
)
from moka.lighting.suns import SplitEnvironment, full_map, split_environment

__all__ = ["LightingMaker"]

# Errors of nine coefficients, relative to the mean irradiance, between which
# ``auto`` makes a cube. Below they suffice: largest errors of coefficients
# and of a cube are 3.1 and 1.2 % for a beach, 3.7 and 3.4 % for soft boxes,
# 2.2 and 0.6 % for the sky, but 5.4 and 1.6 % for the studio. Above a sun is
# in the map; of that they make 20 %, and the samples of a cube 70 to 100 %.
_HARMONICS_SUFFICE = 0.04
_HARMONICS_SEE_A_SUN = 0.12


class LightingMaker:
    """Makes lighting and BRDF tables on one device, each only once.

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
        self._preintegrator = Preintegrator(device, passes)
        self._cache = LightingCache(device, cache)
        self._tables: dict[str, Handle] = {}

    def make(self, request: LightingRequest) -> EnvironmentLighting:
        """What ``request`` asks for, to be destroyed by the caller."""
        lighting = self._cache.load(request)
        if lighting is None:
            lighting = self._make(request)
            self._cache.keep(request, lighting)
        elif request.background:
            self._preintegrator.add_map(
                lighting.maps, full_map(request.environment, request.most_suns)
            )
        return lighting

    def table(self, brdf: str) -> Handle:
        """The BRDF table of ``brdf``; see moka.lighting.brdf_table."""
        if brdf not in self._tables:
            table = self._cache.load_table(brdf)
            if table is None:
                table = make_brdf_table(self._device, self._passes, brdf)
                self._cache.keep_table(brdf, table)
            self._tables[brdf] = table
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

    def _make(self, request: LightingRequest) -> EnvironmentLighting:
        split = split_environment(
            request.environment, request.most_suns, search=not request.sampled
        )
        if request.sampled:
            maps = self._preintegrator.sampled(split.full)
            return EnvironmentLighting(maps, split.suns)
        harmonics = (
            _harmonics(split, request.irradiance_as)
            if request.irradiance
            else None
        )
        maps = self._preintegrator.prepare(
            split,
            background=request.background,
            specular=request.specular,
            irradiance=request.irradiance and harmonics is None,
            radiance=request.radiance,
            half=request.half,
        )
        return EnvironmentLighting(maps, split.suns, harmonics)


def _harmonics(
    split: SplitEnvironment, irradiance_as: str
) -> NDArray[np.float64] | None:
    """Coefficients of irradiance, unless a cube is wanted or better."""
    if irradiance_as == "cube":
        return None
    coefficients = irradiance_harmonics(split.base)
    if irradiance_as == "sh":
        return coefficients
    error = irradiance_error(split.base, coefficients)
    needs_cube = _HARMONICS_SUFFICE < error < _HARMONICS_SEE_A_SUN
    return None if needs_cube else coefficients
