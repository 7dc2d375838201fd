"""What lights the scene of a frame: environment maps, suns and lights."""

import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
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
from moka.lighting.environment import BRIGHTEST, Environment, Sun
from moka.lighting.environment_lighting import (
    EnvironmentLighting,
    LightingRequest,
)
from moka.lighting.environment_maps import EnvironmentMaps
from moka.lighting.lighting_maker import LightingMaker
from moka.renderer.map_needs import MapNeeds
from moka.renderer.permutation import lights_layout
from moka.renderer.view import turn_matrix
from moka.scene.lights import LIGHT
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.lighting.preintegration_passes import Told

__all__ = ["LightSources", "MadeLighting", "light_capacity"]

# 16 KiB of uniform block hold this many.
MOST_LIGHTS = 256
# Above the one light that shaders have a case for.
_SMALLEST_CAPACITY = 4


class MadeLighting(Struct, frozen=True, eq=False):
    """Lighting, and what it was made for: a request, None for darkness."""

    lighting: EnvironmentLighting
    request: LightingRequest | None
    mode: str

    def serves(self, request: LightingRequest | None, mode: str) -> bool:
        """Whether it has all that is asked for, made in the same way."""
        made = self.request
        if made is None or request is None or mode != self.mode:
            return made is request and mode == self.mode
        return request == replace(
            made,
            **{
                kind: getattr(request, kind)
                for kind in ("background", "specular", "irradiance", "radiance")
                if getattr(made, kind)
            },
        )


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
        self._made = MadeLighting(
            EnvironmentLighting(EnvironmentMaps()), None, "nothing yet"
        )
        self._ready: MadeLighting | None = None
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
        self, environment: Environment | None, needs: MapNeeds
    ) -> bool:
        """Have the maps that are asked for; whether they are new ones.

        New ones are to be filled before something reads them.
        """
        request = needs.request(environment)
        if self._made.serves(request, needs.ibl):
            return False
        self._maker.keep()
        self.maps.destroy(self._device)
        made, self._ready = self._ready, None
        if made is not None and not made.serves(request, needs.ibl):
            made.lighting.maps.destroy(self._device)
            made = None
        self._made = made or self._make(request, needs.ibl)
        self._report()
        return True

    def prepare(
        self, environment: Environment | None, needs: MapNeeds, told: "Told"
    ) -> MadeLighting | None:
        """Make lighting for :meth:`adopt`, and write it to the disk cache.

        None if it is there. On a thread that may wait, while others draw;
        see :func:`moka.lighting.make_lighting.make_lighting`.
        """
        request = needs.request(environment)
        if self._made.serves(request, needs.ibl):
            return None
        made = self._make(request, needs.ibl, told)
        self._maker.keep()
        return made

    def adopt(self, made: MadeLighting) -> None:
        """Light with it at the next :meth:`update_maps` that it serves."""
        if self._ready is not None:
            self._ready.lighting.maps.destroy(self._device)
        self._ready = made

    def _make(
        self,
        request: LightingRequest | None,
        mode: str,
        told: "Told | None" = None,
    ) -> MadeLighting:
        if request is None:
            dark = EnvironmentLighting(EnvironmentMaps())
            return MadeLighting(dark, None, mode)
        with self._statistics.stage("environment"):
            lighting = self._maker.make(request, told)
        return MadeLighting(lighting, request, mode)

    def _report(self) -> None:
        """Say in the statistics what lights."""
        kind = "sh" if self.harmonics is not None else None
        if self.maps.irradiance is not None:
            kind = "cube"
        self._statistics.lighting.update(
            mode=self._made.mode,
            suns=len(self.suns),
            irradiance=kind,
            prefiltered_levels=(
                0 if self.maps.specular is None else self.maps.specular_levels
            ),
            cached=self._made.lighting.is_cached,
            samples_per_pixel=0,
            estimated_error=None,
        )

    @property
    def maps(self) -> EnvironmentMaps:
        """The textures of the environment that lights."""
        return self._made.lighting.maps

    @property
    def harmonics(self) -> NDArray[np.float64] | None:
        """Coefficients of its irradiance, where no cube holds it."""
        return self._made.lighting.harmonics

    @property
    def suns(self) -> tuple[Sun, ...]:
        """The suns that are lights, and no part of the specular cube."""
        return self._made.lighting.suns

    @property
    def map_shows_suns(self) -> bool:
        """Whether ``maps.map`` has suns of the environment drawn into it."""
        request = self._made.request
        if request is None:
            return False
        own = sum(not sun.in_map for sun in self.suns)
        return own < len(request.environment.suns)

    def rows(
        self, scene: Scene, origin: NDArray[np.float64]
    ) -> NDArray[np.void]:
        """Lights of the scene and suns of its environment, as LIGHT rows.

        The suns are those of the last :meth:`update_maps`. Raises
        OptionError for more lights than a block can hold.
        """
        rows = scene.light_rows(origin)
        if self.suns:
            rows = np.concatenate([rows, _sun_rows(scene, self.suns)])
        if len(rows) > MOST_LIGHTS:
            suns = len(self.suns)
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
