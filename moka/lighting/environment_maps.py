"""The textures that one environment is on the GPU, and how they are read."""

from collections.abc import Callable

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import (
    MipmapMode,
    PixelFormat,
    SamplerDescriptor,
    TextureDescriptor,
    Wrap,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = [
    "CUBE_FORMAT",
    "CUBE_SAMPLER",
    "MAP_SAMPLER",
    "SOURCE_SAMPLER",
    "EnvironmentMaps",
    "upload_map",
]

# u wraps around, v ends at the poles.
MAP_SAMPLER = SamplerDescriptor(wrap_t=Wrap.CLAMP_TO_EDGE)
CUBE_SAMPLER = SamplerDescriptor(Wrap.CLAMP_TO_EDGE, Wrap.CLAMP_TO_EDGE)
# Samples of a lobe read the nearest level: as exact as mixing two, in three
# quarters of the time.
SOURCE_SAMPLER = SamplerDescriptor(
    Wrap.CLAMP_TO_EDGE, Wrap.CLAMP_TO_EDGE, mipmap=MipmapMode.NEAREST
)

# Float32 holds a sun of any radiance unscaled. Half floats are as exact but
# for that, and not faster to make.
CUBE_FORMAT = PixelFormat.RGBA32F


class EnvironmentMaps(Struct):
    """What is there of one environment; None where nothing asked for it.

    ``map`` is the equirectangular map with its suns, ``specular`` the
    prefiltered cube, whose level 0 is the mirror image of that map and
    whose other levels, of :func:`moka.lighting.specular_cube.level_roughness`,
    lack the suns. ``irradiance`` is a cube of E / pi, without them too;
    ``radiance`` is the environment itself without them, with levels, as
    filtered lighting samples it. ``importance`` is the table by which
    reference lighting samples ``map``. The cubes hold nothing before
    :meth:`fill`, for which ``draw`` is kept.
    """

    map: Handle | None = None
    specular: Handle | None = None
    specular_levels: int = 1
    irradiance: Handle | None = None
    radiance: Handle | None = None
    radiance_levels: int = 1
    importance: Handle | None = None
    resources: list[Handle] = []
    draw: Callable[[], None] | None = None

    @property
    def lights_surfaces(self) -> bool:
        """Whether surfaces reflect the environment."""
        return self.specular is not None or self.importance is not None

    def add_map(
        self, device: GraphicsDevice, pixels: NDArray[np.float32]
    ) -> None:
        """Upload ``pixels`` (H, W, 3) as ``map``."""
        self.map = upload_map(device, pixels)
        self.resources.append(self.map)

    def fill(self) -> None:
        """Have drawn what the cubes hold, the first time.

        Apart from their making, so that the programs of whatever reads them
        are compiled beside those that draw them.
        """
        if self.draw is not None:
            draw, self.draw = self.draw, None
            draw()

    def destroy(self, device: GraphicsDevice) -> None:
        """Destroy all of it."""
        self.fill()  # Lets go of what only this needs.
        device.destroy(*self.resources)
        self.resources.clear()


def upload_map(device: GraphicsDevice, pixels: NDArray[np.float32]) -> Handle:
    """A texture of an equirectangular map (H, W, 3)."""
    height, width = pixels.shape[:2]
    # Four floats are one load, three are not: the sky is drawn in two thirds
    # of the time here.
    texels = np.empty((height, width, 4), np.float32)
    texels[:, :, 3] = 1.0
    for channel in range(3):
        # Three times as fast as all three at once.
        texels[:, :, channel] = pixels[:, :, channel]
    return device.create_texture(
        TextureDescriptor(
            PixelFormat.RGBA32F, width, height, label="environment map"
        ),
        [texels],
    )
