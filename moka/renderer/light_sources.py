"""What lights the scene of a frame: environment maps, suns and lights."""

import math

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    BufferDescriptor,
    BufferUsage,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.core.errors import OptionError
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment import Environment, Sun
from moka.lighting.importance import importance_table
from moka.lighting.preintegration import EnvironmentMaps, Preintegrator
from moka.lighting.spherical_harmonics import (
    irradiance_error,
    irradiance_harmonics,
)
from moka.lighting.suns import AUTO_SUNS, SplitEnvironment, split_environment
from moka.renderer.permutation import lights_layout
from moka.renderer.view import turn_matrix
from moka.scene.lights import LIGHT
from moka.scene.scene import Scene

__all__ = ["LightSources", "light_capacity"]

# 16 KiB of uniform block hold this many.
MOST_LIGHTS = 256
_SMALLEST_CAPACITY = 4

# Errors of nine coefficients, relative to the mean irradiance, between which
# ``auto`` makes a cube. Below they suffice: largest errors of coefficients
# and of a cube are 3.1 and 1.2 % for a beach, 3.7 and 3.4 % for soft boxes,
# 2.2 and 0.6 % for the sky, but 5.4 and 1.6 % for the studio. Above a sun is
# in the map; of that they make 20 %, and the samples of a cube 70 to 100 %.
_HARMONICS_SUFFICE = 0.04
_HARMONICS_SEE_A_SUN = 0.12


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
        self.harmonics: NDArray[np.float64] | None = None
        self._environment: Environment | None = None
        self._suns: tuple[Sun, ...] = ()
        self._options: tuple[str | int, str, str] = ("auto", "auto", "")
        self._made = (False,) * 4
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
        suns: str | int = "auto",
        irradiance_as: str = "auto",
        ibl: str = "split-sum",
    ) -> bool:
        """Have the maps that are asked for; whether they are new ones.

        ``specular`` and ``irradiance`` are what surfaces reflect; ``suns``,
        ``irradiance_as`` and ``ibl`` are RenderSettings' ``suns``,
        ``irradiance`` and ``ibl``. Reference lighting samples the map with
        its suns and nothing else.
        """
        sampled = ibl == "reference" and (specular or irradiance)
        if sampled:
            background, suns = True, "off"
            specular = irradiance = False
        options = (suns, irradiance_as, ibl)
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
        self.maps.destroy(self._device)
        self.maps = EnvironmentMaps()
        self.harmonics, self._suns = None, ()
        if environment is not None and any(wanted):
            with self._statistics.stage("environment"):
                most = {"auto": AUTO_SUNS, "off": 0}.get(str(suns), suns)
                split = split_environment(environment, int(most))
                self._suns = split.suns
                if irradiance:
                    self.harmonics = _harmonics(split, irradiance_as)
                self.maps = self._preintegrator.prepare(
                    split,
                    background=background,
                    specular=specular,
                    irradiance=irradiance and self.harmonics is None,
                    radiance=ibl == "filtered" and specular,
                )
                if sampled:
                    self._add_importance(split)
        self._environment, self._made = environment, wanted
        self._options = options
        self._report()
        return True

    def _report(self) -> None:
        """Say in the statistics what lights."""
        kind = "sh" if self.harmonics is not None else None
        if self.maps.irradiance is not None:
            kind = "cube"
        self._statistics.lighting.update(
            mode=self._options[2],
            suns=len(self._suns),
            irradiance=kind,
            prefiltered_levels=(
                0 if self.maps.specular is None else self.maps.specular_levels
            ),
            cached=False,
            samples_per_pixel=0,
            estimated_error=None,
        )

    def _add_importance(self, environment: SplitEnvironment) -> None:
        """Add the table by which the whole map is sampled."""
        table = importance_table(environment.full)
        height, width, _ = table.shape
        texture = self._device.create_texture(
            TextureDescriptor(
                PixelFormat.RGBA32F, width, height, label="importance table"
            ),
            [table],
        )
        self.maps.importance = texture
        self.maps.resources.append(texture)

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


def _sun_rows(scene: Scene, suns: tuple[Sun, ...]) -> NDArray[np.void]:
    """Suns as directional lights: their irradiance is in lux's place."""
    rows = np.zeros(len(suns), LIGHT)
    world_from_environment = turn_matrix(scene.environment_rotation).T
    for row, sun in zip(rows, suns, strict=True):
        row["direction"] = -(world_from_environment @ sun.direction)
        row["intensity"] = scene.environment_intensity * np.asarray(
            sun.irradiance
        )
        row["angle_offset"] = 1.0
        # Above 0, by which the shader knows a sun: it is in the map as well.
        row["angular_radius"] = max(sun.angular_radius, 1e-6)
    return rows
