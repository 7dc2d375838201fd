"""Turns an environment into the textures that lighting reads, on the GPU.

Split-sum image-based lighting (Karis 2013): the equirectangular map becomes
a cube map, its levels are prefiltered for the GGX lobe of growing roughness,
and a small cube holds irradiance. Each is made only when something asks for
it.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import PixelFormat, TextureDescriptor
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment_maps import EnvironmentMaps, upload_map
from moka.lighting.importance import importance_table
from moka.lighting.irradiance_cube import irradiance_cube
from moka.lighting.preintegration_passes import (
    CUBE_FACES,
    PreintegrationPasses,
    Told,
)
from moka.lighting.radiance_cube import (
    cube_size,
    downsample,
    faces_that_differ,
    map_to_cube,
    uniform_cube,
)
from moka.lighting.specular_cube import prefilter, specular_level_count

if TYPE_CHECKING:
    from moka.lighting.suns import SplitEnvironment

__all__ = ["Preintegrator"]


class Preintegrator:
    """Makes environment maps on one device, in pieces if one is ``told``."""

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        told: Told | None = None,
    ) -> None:
        self._device = device
        self._passes = passes
        self._told = told

    def sampled(self, pixels: NDArray[np.float32]) -> EnvironmentMaps:
        """A map and the table by which reference lighting samples it."""
        maps = EnvironmentMaps()
        maps.add_map(self._device, pixels)
        table = importance_table(pixels)
        height, width, _ = table.shape
        maps.importance = self._device.create_texture(
            TextureDescriptor(
                PixelFormat.RGBA32F, width, height, label="importance table"
            ),
            [table],
        )
        maps.resources.append(maps.importance)
        return maps

    def prepare(
        self,
        environment: "SplitEnvironment",
        *,
        background: bool,
        specular: bool,
        irradiance: bool,
        radiance: bool = False,
        half: bool = False,
    ) -> EnvironmentMaps:
        """Make what is asked for of ``environment``, to be filled.

        ``irradiance`` asks for a cube of it; ``radiance``, with one of the
        two before, to keep the cube that they are made from. Of a uniform
        environment there is none. With ``half`` cubes have half as many
        texels along an edge.
        """
        maps = EnvironmentMaps()
        pixels = environment.full
        reflects = specular or irradiance
        is_uniform = pixels.shape[:2] == (1, 1)
        if background or (reflects and not is_uniform):
            maps.add_map(self._device, pixels)
        if is_uniform and reflects:
            cube = uniform_cube(self._device, pixels[0, 0])
            maps.resources.append(cube)
            maps.specular = cube if specular else None
            maps.irradiance = cube if irradiance else None
        elif reflects:
            self._fill(
                maps,
                environment,
                specular=specular,
                irradiance=irradiance,
                radiance=radiance,
                size=cube_size(len(pixels), half=half),
            )
        return maps

    def _fill(
        self,
        maps: EnvironmentMaps,
        environment: "SplitEnvironment",
        *,
        specular: bool,
        irradiance: bool,
        radiance: bool,
        size: int,
    ) -> None:
        """Make the cubes of an environment whose map is there."""
        assert maps.map is not None
        passes = PreintegrationPasses(self._device, self._passes, self._told)
        passes.pause()
        height = len(environment.full)
        has_suns = environment.base is not environment.full
        base = (
            passes.scratch(upload_map(self._device, environment.base))
            if has_suns
            else maps.map
        )
        passes.pause()
        source = passes.scratch(passes.cube(size, size.bit_length()))
        # A base is so even that one bilinear sample a texel is as good.
        map_to_cube(passes, base, height, source, size, fine=not has_suns)
        downsample(passes, source, size)
        if specular:
            maps.specular_levels = specular_level_count(size)
            maps.specular = passes.cube(size, maps.specular_levels)
            maps.resources.append(maps.specular)
            if has_suns:
                # A mirror shows the suns. The rougher levels lack them:
                # there a sun is a light, in the measure in which these
                # levels are read.
                sunny = faces_that_differ(environment.full, environment.base)
                same = set(CUBE_FACES) - sunny
                passes.copy_faces(source, maps.specular, same)
                for face in sunny:
                    map_to_cube(
                        *(passes, maps.map, height, maps.specular, size),
                        faces=[face],
                        fine=True,
                    )
            prefilter(passes, source, size, maps.specular, int(has_suns))
        if irradiance:
            maps.irradiance = irradiance_cube(passes, source, size)
            maps.resources.append(maps.irradiance)
        if radiance:
            maps.radiance = passes.kept(source)
            maps.radiance_levels = size.bit_length()
            maps.resources.append(source)
        maps.draw = passes.run
        if self._told is not None:
            maps.fill()
