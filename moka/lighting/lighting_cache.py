"""Preintegrated lighting, kept on disk from one run to the next.

What is found by its key need not be made: neither the passes over the
environment, nor their programs, nor what the CPU finds out about suns and
irradiance. It is what this very driver made of this very environment, read
back to the last bit, so that pictures with and without the cache are the
same.
"""

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import TextureDescriptor, TextureKind
from moka.core.log import get_logger
from moka.graphics.device import GraphicsDevice
from moka.lighting.code_digest import code_digest
from moka.lighting.disk_cache import Arrays, DiskCache
from moka.lighting.environment import Sun
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.environment_maps import CUBE_FORMAT, EnvironmentMaps

__all__ = ["LightingCache"]

_LOGGER = get_logger(__name__)


class LightingCache:
    """Finds and keeps lighting of one device.

    Without ``files`` it finds nothing and keeps nothing. What is kept is
    read back and written by :meth:`flush`, at a time when nobody waits. Of
    threads that do, the second waits for the first.
    """

    def __init__(self, device: GraphicsDevice, files: DiskCache | None) -> None:
        self._device = device
        self._files = files
        self._pending: dict[str, Callable[[], Arrays]] = {}
        self._flushing = Lock()

    def load(self, request: LightingRequest) -> EnvironmentLighting | None:
        """What ``request`` led to before, on the GPU again.

        Without the environment map itself, which is the caller's to upload.
        """
        if self._files is None or not _takes_time(request):
            return None
        arrays = self._files.load(self._environment_key(request))
        _LOGGER.info(
            "lighting of %s: %s",
            request.environment.name,
            "is made" if arrays is None else "is in the cache",
        )
        return None if arrays is None else self._uploaded(arrays)

    def keep(
        self, request: LightingRequest, lighting: EnvironmentLighting
    ) -> None:
        """Write ``lighting`` at the next :meth:`flush`, if it is alive."""
        if self._files is not None and _takes_time(request):
            key = self._environment_key(request)
            self._pending[key] = lambda: self._read_lighting(lighting)

    @property
    def is_pending(self) -> bool:
        """Whether :meth:`flush` has anything to write."""
        return bool(self._pending)

    def flush(self) -> None:
        """Write what is to be kept; waits for the GPU and the disk."""
        with self._flushing:
            while self._pending:
                key, read = self._pending.popitem()
                assert self._files is not None
                self._files.store(key, read())

    def _environment_key(self, request: LightingRequest) -> str:
        return self._key(
            "environment",
            request.environment.digest.hex(),
            request.most_suns,
            request.irradiance_as,
            request.specular,
            request.irradiance,
            request.radiance,
            request.half,
        )

    def _key(self, *parts: object) -> str:
        """A key of ``parts``, of this driver and of how moka makes things."""
        info = self._device.info
        driver = (info.kind, info.vendor, info.renderer, info.version)
        from hashlib import blake2b

        text = repr((parts, driver, code_digest()))
        return blake2b(text.encode(), digest_size=20).hexdigest()

    def _uploaded(self, arrays: Arrays) -> EnvironmentLighting:
        maps = EnvironmentMaps()
        for name in ("specular", "irradiance", "radiance"):
            levels: list[NDArray[Any]] = []
            while (level := arrays.get(f"{name} {len(levels)}")) is not None:
                levels.append(level)
            if not levels:
                continue
            size = levels[0].shape[1]
            cube = self._device.create_texture(
                TextureDescriptor(
                    CUBE_FORMAT, size, size, TextureKind.CUBE, len(levels)
                ),
                levels,
            )
            setattr(maps, name, cube)
            maps.resources.append(cube)
            if name == "specular":
                maps.specular_levels = len(levels)
        suns = tuple(
            Sun((x, y, z), (red, green, blue), radius, bool(in_map))
            for x, y, z, red, green, blue, radius, in_map in (
                arrays["suns"].tolist()
            )
        )
        harmonics = arrays.get("harmonics")
        if harmonics is not None:
            # A view would keep the whole file in memory.
            harmonics = harmonics.copy()
        return EnvironmentLighting(maps, suns, harmonics, is_cached=True)

    def _read_lighting(self, lighting: EnvironmentLighting) -> Arrays:
        maps = lighting.maps
        maps.fill()
        arrays: dict[str, NDArray[Any]] = {
            "suns": np.array(
                [
                    (
                        *sun.direction,
                        *sun.irradiance,
                        sun.angular_radius,
                        sun.in_map,
                    )
                    for sun in lighting.suns
                ]
            ).reshape(-1, 8)
        }
        if lighting.harmonics is not None:
            arrays["harmonics"] = lighting.harmonics
        for name, levels in (
            ("specular", maps.specular_levels),
            ("irradiance", 1),
            ("radiance", maps.radiance_levels),
        ):
            cube = getattr(maps, name)
            if cube is None:
                continue
            for level in range(levels):
                arrays[f"{name} {level}"] = np.stack(
                    [
                        self._device.read_texture(cube, level=level, face=face)
                        for face in range(6)
                    ]
                )
        return arrays


def _takes_time(request: LightingRequest) -> bool:
    """Whether there is anything to make; of uniform light there is not."""
    return not request.environment.is_uniform and (
        request.specular or request.irradiance
    )
