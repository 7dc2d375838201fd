"""What lights the scene of a frame: environment maps, suns and lights."""

import math

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    BufferDescriptor,
    BufferUsage,
)
from moka.commands.handles import Handle
from moka.core.errors import OptionError
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.disk_cache import DiskCache
from moka.lighting.environment import (
    AUTO_SUNS,
    BRIGHTEST,
    Environment,
    Sun,
)
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.environment_maps import EnvironmentMaps
from moka.lighting.lighting_maker import LightingMaker
from moka.renderer.permutation import lights_layout
from moka.renderer.settings import MOST_SUNS
from moka.renderer.view import turn_matrix
from moka.scene.lights import LIGHT
from moka.scene.scene import Scene

__all__ = ["LightSources", "light_capacity"]

# 16 KiB of uniform block hold this many.
MOST_LIGHTS = 256
# Above the one light that shaders have a case for.
_SMALLEST_CAPACITY = 4


class LightSources:
    """Environment maps and the buffer of lights, made as they are needed."""

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        statistics: Statistics,
        cache: DiskCache | None = None,
    ) -> None:
        self._device = device
        self._maker = LightingMaker(device, passes, cache)
        self._statistics = statistics
        self.maps = EnvironmentMaps()
        self.harmonics: NDArray[np.float64] | None = None
        self._environment: Environment | None = None
        self._suns: tuple[Sun, ...] = ()
        self._options: tuple[str | int, ...] = ()
        self._made = (False,) * 4
        self._buffers: dict[int, Handle] = {}

    def table(self, brdf: str) -> Handle:
        """The BRDF table; see moka.lighting.brdf_table."""
        return self._maker.table(brdf)

    @property
    def has_something_to_keep(self) -> bool:
        """Whether :meth:`keep` would write anything."""
        return self._maker.has_something_to_keep

    def keep(self) -> None:
        """Write what is new to the disk cache; see LightingMaker.keep."""
        self._maker.keep()

    def update_maps(
        self,
        environment: Environment | None,
        *,
        background: bool,
        specular: bool,
        irradiance: bool,
        suns: str | int = "auto",
        irradiance_as: str = "auto",
        ibl: str = "split-sum",
        reflections: str = "full",
        blurred: bool = False,
    ) -> bool:
        """Have the maps that are asked for; whether they are new ones.

        ``specular`` and ``irradiance`` are what surfaces reflect; ``suns``,
        ``irradiance_as``, ``ibl`` and ``reflections`` are RenderSettings'
        ``suns``, ``irradiance``, ``ibl`` and ``reflections``. With
        ``blurred`` the background is read from the specular cube. Reference
        lighting samples the map as it is, and the environment's own suns as
        discs.
        """
        sampled = ibl == "reference" and (specular or irradiance)
        if sampled:
            background, suns = True, MOST_SUNS
            specular = irradiance = False
        specular |= blurred
        options = (suns, irradiance_as, ibl, reflections)
        wanted = (
            (background, specular, irradiance, sampled)
            if environment is not None
            else (False,) * 4
        )
        same = environment is self._environment and options == self._options
        if same and all(
            made or not want
            for made, want in zip(self._made, wanted, strict=True)
        ):
            return False
        self._maker.keep()
        self.maps.destroy(self._device)
        lighting = EnvironmentLighting(EnvironmentMaps())
        if environment is not None and any(wanted):
            with self._statistics.stage("environment"):
                lighting = self._maker.make(
                    LightingRequest(
                        environment,
                        _most_suns(suns),
                        irradiance_as,
                        background=background,
                        specular=specular,
                        irradiance=irradiance,
                        radiance=ibl == "filtered" and specular,
                        sampled=sampled,
                        half=reflections == "half",
                    )
                )
        self.maps, self._suns = lighting.maps, lighting.suns
        self.harmonics = lighting.harmonics
        self._environment, self._made = environment, wanted
        self._options = options
        self._report(ibl, is_cached=lighting.is_cached)
        return True

    def _report(self, mode: str, *, is_cached: bool) -> None:
        """Say in the statistics what lights."""
        kind = "sh" if self.harmonics is not None else None
        if self.maps.irradiance is not None:
            kind = "cube"
        self._statistics.lighting.update(
            mode=mode,
            suns=len(self._suns),
            irradiance=kind,
            prefiltered_levels=(
                0 if self.maps.specular is None else self.maps.specular_levels
            ),
            cached=is_cached,
            samples_per_pixel=0,
            estimated_error=None,
        )

    @property
    def suns(self) -> tuple[Sun, ...]:
        """The suns that are lights, and no part of the specular cube."""
        return self._suns

    @property
    def map_shows_suns(self) -> bool:
        """Whether ``maps.map`` has suns of the environment drawn into it."""
        if self._environment is None:
            return False
        own = sum(not sun.in_map for sun in self._suns)
        return own < len(self._environment.suns)

    def rows(
        self, scene: Scene, origin: NDArray[np.float64]
    ) -> NDArray[np.void]:
        """Lights of the scene and suns of its environment, as LIGHT rows.

        The suns are those of the last :meth:`update_maps`. Raises
        OptionError for more lights than a block can hold.
        """
        rows = scene.light_rows(origin)
        if self._suns:
            rows = np.concatenate([rows, _sun_rows(scene, self._suns)])
        if len(rows) > MOST_LIGHTS:
            suns = len(self._suns)
            beside = f" and {suns} sun{'s' * (suns > 1)}" if suns else ""
            advice = "; turn suns off to leave them in the map" if suns else ""
            raise OptionError(
                f"scene: {len(rows) - suns} lights{beside} shine; moka draws "
                f"up to {MOST_LIGHTS} at once{advice}"
            )
        return rows

    def buffer(self, capacity: int) -> Handle:
        """The uniform buffer for up to ``capacity`` lights."""
        if capacity not in self._buffers:
            size = lights_layout(capacity).size
            self._buffers[capacity] = self._device.create_buffer(
                BufferDescriptor(
                    BufferUsage.UNIFORM, size, dynamic=True, label="lights"
                ),
                np.zeros(size, np.uint8),
            )
        return self._buffers[capacity]


def light_capacity(count: int) -> int:
    """Rows of the block that holds ``count`` lights; 0 for none.

    A power of two, so that a light more or less seldom changes shaders.
    """
    if count < 2:
        return count
    return max(_SMALLEST_CAPACITY, 1 << math.ceil(math.log2(count)))


def _most_suns(suns: str | int) -> int:
    if isinstance(suns, int):
        return suns
    return AUTO_SUNS if suns == "auto" else 0


def _sun_rows(scene: Scene, suns: tuple[Sun, ...]) -> NDArray[np.void]:
    """Suns as directional lights: their irradiance is in lux's place."""
    rows = np.zeros(len(suns), LIGHT)
    world_from_environment = turn_matrix(scene.environment_rotation).T
    for row, sun in zip(rows, suns, strict=True):
        row["direction"] = -(world_from_environment @ sun.direction)
        irradiance = np.array(sun.irradiance) * scene.environment_intensity
        row["intensity"] = np.minimum(irradiance, BRIGHTEST)
        row["angle_offset"] = 1.0
        # Above 0, by which the shader knows a sun.
        row["angular_radius"] = max(sun.angular_radius, 1e-6)
        row["in_map"] = sun.in_map
    return rows
