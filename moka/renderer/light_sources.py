"""What lights the scene of a frame: environment maps, suns and lights."""

import math

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import BufferDescriptor, BufferUsage
from moka.commands.handles import Handle
from moka.core.errors import OptionError
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment import Environment
from moka.lighting.preintegration import EnvironmentMaps, Preintegrator
from moka.renderer.permutation import lights_layout
from moka.renderer.view import turn_matrix
from moka.scene.lights import LIGHT
from moka.scene.scene import Scene

__all__ = ["LightSources", "light_capacity"]

# 16 KiB of uniform block hold this many.
MOST_LIGHTS = 256
_SMALLEST_CAPACITY = 4


class LightSources:
    """Environment maps and the buffer of lights, made as they are needed."""

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        statistics: Statistics,
    ) -> None:
        self._device = device
        self._preintegrator = Preintegrator(device, passes)
        self._statistics = statistics
        self.maps = EnvironmentMaps()
        self._environment: Environment | None = None
        self._made = (False, False, False)
        self._buffers: dict[int, Handle] = {}

    def table(self, brdf: str) -> Handle:
        """The BRDF table; see Preintegrator.brdf_table."""
        return self._preintegrator.brdf_table(brdf)

    def update_maps(
        self,
        environment: Environment | None,
        *,
        background: bool,
        specular: bool,
        irradiance: bool,
    ) -> bool:
        """Have the maps that are asked for; whether they are new ones."""
        wanted = (
            (background, specular, irradiance)
            if environment is not None
            else (False, False, False)
        )
        same = environment is self._environment
        if same and all(
            made or not want
            for made, want in zip(self._made, wanted, strict=True)
        ):
            return False
        self.maps.destroy(self._device)
        self.maps = EnvironmentMaps()
        if environment is not None and any(wanted):
            with self._statistics.stage("environment"):
                self.maps = self._preintegrator.prepare(
                    environment,
                    background=background,
                    specular=specular,
                    irradiance=irradiance,
                )
        self._environment, self._made = environment, wanted
        return True

    def rows(
        self, scene: Scene, origin: NDArray[np.float64]
    ) -> NDArray[np.void]:
        """Lights of the scene and suns of its environment, as LIGHT rows.

        Raises OptionError for more lights than a block can hold.
        """
        rows = scene.light_rows(origin)
        environment = scene.environment
        if environment is not None and environment.suns:
            rows = np.concatenate([rows, _sun_rows(scene, environment)])
        if len(rows) > MOST_LIGHTS:
            raise OptionError(
                f"scene: {len(rows)} lights shine; moka draws up to "
                f"{MOST_LIGHTS} at once"
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
    if not count:
        return 0
    return max(_SMALLEST_CAPACITY, 1 << math.ceil(math.log2(count)))


def _sun_rows(scene: Scene, environment: Environment) -> NDArray[np.void]:
    """Suns as directional lights: their irradiance is in lux's place."""
    rows = np.zeros(len(environment.suns), LIGHT)
    world_from_environment = turn_matrix(scene.environment_rotation).T
    for row, sun in zip(rows, environment.suns, strict=True):
        row["direction"] = -(world_from_environment @ sun.direction)
        row["intensity"] = scene.environment_intensity * np.asarray(
            sun.irradiance
        )
        row["angle_offset"] = 1.0
    return rows
