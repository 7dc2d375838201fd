"""Turns an environment into the textures that lighting reads, on the GPU.

Split-sum image-based lighting (Karis 2013): the equirectangular map becomes
a cube map, its mip levels are prefiltered for the GGX lobe of growing
roughness, a small cube holds irradiance, and a table the directional albedo
of the lobe. Each of them is made only when something asks for it. The cost
is measured by the statistics stage ``environment``.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    MipmapMode,
    PixelFormat,
    SamplerDescriptor,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
    UniformBinding,
    Wrap,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FULLSCREEN, FullscreenPasses
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.lighting.samples import (
    cosine_samples,
    ggx_prefilter_samples,
    pack,
)

if TYPE_CHECKING:
    from moka.lighting.suns import SplitEnvironment

__all__ = [
    "CUBE_SAMPLER",
    "MAP_SAMPLER",
    "TABLE_SAMPLER",
    "EnvironmentMaps",
    "Preintegrator",
    "cube_size",
    "level_roughness",
    "specular_level_count",
]

# u wraps around, v ends at the poles.
MAP_SAMPLER = SamplerDescriptor(wrap_t=Wrap.CLAMP_TO_EDGE)
CUBE_SAMPLER = SamplerDescriptor(Wrap.CLAMP_TO_EDGE, Wrap.CLAMP_TO_EDGE)
# Samples of a lobe read the nearest level: as exact as mixing two, in three
# quarters of the time.
SOURCE_SAMPLER = SamplerDescriptor(
    Wrap.CLAMP_TO_EDGE, Wrap.CLAMP_TO_EDGE, mipmap=MipmapMode.NEAREST
)
TABLE_SAMPLER = CUBE_SAMPLER

# Within 0.0028 of float64 quadrature at every texel.
TABLE_SIZE = 128
TABLE_FORMAT = PixelFormat.RG32F
TABLE_SAMPLES = 512
# Samples for the first rough level; each level below has a quarter of the
# texels, a wider lobe, and twice as many. Without suns in the map more than
# 128 change nothing: spheres under a beach and a studio have the same median
# error within 0.001 with up to 512. Half as many for all levels take the
# error at roughness 0.1 to 0.3 from 0.014 to 0.022 and 0.031 to 0.044.
SPECULAR_SAMPLES = 32
MOST_SPECULAR_SAMPLES = 128
IRRADIANCE_SAMPLES = 512
IRRADIANCE_SIZE = 16
# The level of roughness 1 has this many texels along an edge: its lobe is
# wider than they are.
SMALLEST_SPECULAR = 8
LARGEST_CUBE = 1024
# Float32 holds a sun of any radiance unscaled. Half floats are as exact but
# for that, and not faster to make.
CUBE_FORMAT = PixelFormat.RGBA32F

_CUBE_FACE = UniformLayout(
    "CubeFace",
    (
        Parameter("face", ParameterType.INT),
        Parameter("size", ParameterType.INT),
        Parameter("subdivisions", ParameterType.INT),
        Parameter("source_lod", ParameterType.FLOAT),
    ),
)


@dataclass(slots=True)
class EnvironmentMaps:
    """What is there of one environment; None where nothing asked for it.

    ``map`` is the equirectangular map with its suns, ``specular`` the
    prefiltered cube, whose level 0 is the mirror image of that map and
    whose other levels, of :func:`level_roughness`, lack the suns.
    ``irradiance`` is a cube of E / pi, without them too; ``radiance`` is the
    environment itself without them, with levels, as filtered lighting
    samples it. ``importance`` is the table by which reference lighting
    samples ``map``.
    """

    map: Handle | None = None
    specular: Handle | None = None
    specular_levels: int = 1
    irradiance: Handle | None = None
    radiance: Handle | None = None
    radiance_levels: int = 1
    importance: Handle | None = None
    resources: list[Handle] = field(default_factory=list)

    @property
    def lights_surfaces(self) -> bool:
        """Whether surfaces reflect the environment."""
        return self.specular is not None or self.importance is not None

    def destroy(self, device: GraphicsDevice) -> None:
        """Destroy all of it."""
        device.destroy(*self.resources)
        self.resources.clear()


def cube_size(map_height: int) -> int:
    """Texels along a cube's edge for a map of ``map_height`` rows.

    As many to the right angle as the map has at its equator, rounded up to
    a power of two.
    """
    # At least two levels: a mirror image, and one for all rough surfaces.
    texels = max(map_height / 2, 2 * SMALLEST_SPECULAR)
    return min(LARGEST_CUBE, 1 << int(np.ceil(np.log2(texels))))


def specular_level_count(size: int) -> int:
    """Levels of a prefiltered cube of ``size``; the last is roughness 1."""
    return max(1, (size // SMALLEST_SPECULAR).bit_length())


def level_roughness(level: int, levels: int) -> float:
    """The roughness that level ``level`` of ``levels`` is filtered for.

    The inverse of ``specular_level`` in ``include/lighting.glsl``.
    """
    return 1.0 - math.sqrt(1.0 - level / max(1, levels - 1))


class Preintegrator:
    """Makes environment maps and BRDF tables on one device."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes

    def brdf_table(self, brdf: str) -> Handle:
        """Make the table of ``gltf``, ``karis`` or ``blinn-phong``.

        x is n.v, y is roughness, red the scale of f0, green that of f90.
        """
        table = self._device.create_texture(
            TextureDescriptor(
                TABLE_FORMAT, TABLE_SIZE, TABLE_SIZE, label="table"
            )
        )
        jobs = _Jobs(self._device, self._passes)
        jobs.draw(
            "brdf_table.frag",
            {
                f"MOKA_BRDF_{brdf.upper().replace('-', '_')}": 1,
                "MOKA_SAMPLE_COUNT": TABLE_SAMPLES,
            },
            Attachment(table),
        )
        jobs.run()
        return table

    def add_map(
        self, maps: EnvironmentMaps, pixels: NDArray[np.float32]
    ) -> None:
        """Upload ``pixels`` as the ``map`` of ``maps``."""
        maps.map = self._upload_map(pixels)
        maps.resources.append(maps.map)

    def prepare(
        self,
        environment: "SplitEnvironment",
        *,
        background: bool,
        specular: bool,
        irradiance: bool,
        radiance: bool = False,
    ) -> EnvironmentMaps:
        """Make what is asked for of ``environment``.

        ``irradiance`` asks for a cube of it; ``radiance``, with one of the
        two before, to keep the cube that they are made from. Of a uniform
        environment there is none.
        """
        maps = EnvironmentMaps()
        pixels = environment.full
        is_uniform = pixels.shape[:2] == (1, 1)
        if background or ((specular or irradiance) and not is_uniform):
            self.add_map(maps, pixels)
        if is_uniform:
            # Every direction is alike: one texel a face says it all.
            if specular or irradiance:
                cube = self._uniform_cube(pixels[0, 0], maps)
                maps.specular = cube if specular else None
                maps.irradiance = cube if irradiance else None
            return maps
        if not (specular or irradiance):
            return maps
        assert maps.map is not None
        size = cube_size(len(pixels))
        jobs = _Jobs(self._device, self._passes)
        has_suns = environment.base is not pixels
        base = (
            jobs.scratch(self._upload_map(environment.base))
            if has_suns
            else maps.map
        )
        height = len(pixels)
        source = jobs.scratch_cube(size, size.bit_length())
        # A base is so even that one bilinear sample a texel is as good.
        jobs.map_to_cube(base, height, source, size, 1 if has_suns else 2)
        self._downsample(jobs, source, size)
        if specular:
            maps.specular_levels = specular_level_count(size)
            maps.specular = self._prefilter(
                jobs, source, size, maps, height if has_suns else 0
            )
        if irradiance:
            maps.irradiance = self._convolve(jobs, source, size, maps)
        if radiance:
            maps.radiance = jobs.kept(source)
            maps.radiance_levels = size.bit_length()
            maps.resources.append(source)
        jobs.run()
        return maps

    def _upload_map(self, pixels: NDArray[np.float32]) -> Handle:
        height, width = pixels.shape[:2]
        return self._device.create_texture(
            TextureDescriptor(
                PixelFormat.RGB32F, width, height, label="environment map"
            ),
            [pixels],
        )

    def _uniform_cube(
        self, radiance: NDArray[np.float32], maps: EnvironmentMaps
    ) -> Handle:
        texel = np.append(radiance, np.float32(1))
        cube = self._device.create_texture(
            TextureDescriptor(CUBE_FORMAT, 1, 1, TextureKind.CUBE),
            [np.tile(texel, (6, 1, 1, 1))],
        )
        maps.resources.append(cube)
        return cube

    def _downsample(self, jobs: "_Jobs", cube: Handle, size: int) -> None:
        """Make the levels of a cube from its level 0."""
        for level in range(1, size.bit_length()):
            jobs.cube_level(
                "downsample_cube.frag",
                {},
                cube,
                level,
                size >> level,
                TextureBinding(
                    "environment_cube", cube, CUBE_SAMPLER, level - 1
                ),
            )

    def _prefilter(
        self,
        jobs: "_Jobs",
        source: Handle,
        size: int,
        maps: EnvironmentMaps,
        map_height: int,
    ) -> Handle:
        """The levels; level 0 from the map, of ``map_height`` if it differs.

        A mirror shows the suns. The rougher levels lack them: there a sun is
        a light, in the measure in which these levels are read.
        """
        levels = maps.specular_levels
        cube = self._device.create_texture(
            TextureDescriptor(CUBE_FORMAT, size, size, TextureKind.CUBE, levels)
        )
        maps.resources.append(cube)
        if map_height:
            assert maps.map is not None
            jobs.map_to_cube(maps.map, map_height, cube, size, 2)
        for level in range(1 if map_height else 0, levels):
            roughness = level_roughness(level, levels)
            count = min(
                SPECULAR_SAMPLES << max(0, level - 1), MOST_SPECULAR_SAMPLES
            )
            jobs.cube_level(
                "prefilter_specular.frag",
                # One program for all levels: the block holds the most.
                {"MOKA_SAMPLE_COUNT": MOST_SPECULAR_SAMPLES},
                cube,
                level,
                size >> level,
                TextureBinding("environment_cube", source, SOURCE_SAMPLER),
                samples=pack(
                    ggx_prefilter_samples(roughness, count, size),
                    MOST_SPECULAR_SAMPLES,
                ),
            )
        return cube

    def _convolve(
        self, jobs: "_Jobs", source: Handle, size: int, maps: EnvironmentMaps
    ) -> Handle:
        cube = self._device.create_texture(
            TextureDescriptor(
                CUBE_FORMAT, IRRADIANCE_SIZE, IRRADIANCE_SIZE, TextureKind.CUBE
            )
        )
        maps.resources.append(cube)
        jobs.cube_level(
            "prefilter_irradiance.frag",
            {"MOKA_SAMPLE_COUNT": IRRADIANCE_SAMPLES},
            cube,
            0,
            IRRADIANCE_SIZE,
            TextureBinding("environment_cube", source, SOURCE_SAMPLER),
            samples=pack(
                cosine_samples(IRRADIANCE_SAMPLES, size), IRRADIANCE_SAMPLES
            ),
        )
        return cube


class _Jobs:
    """Full-screen passes in one command list, and what they need meanwhile."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._commands = CommandList()
        self._scratch: list[Handle] = []

    def scratch(self, resource: Handle) -> Handle:
        """``resource``, which lives until :meth:`run`."""
        self._scratch.append(resource)
        return resource

    def kept(self, resource: Handle) -> Handle:
        """``resource``, which :meth:`run` does not destroy after all."""
        self._scratch.remove(resource)
        return resource

    def scratch_cube(self, size: int, levels: int) -> Handle:
        """A cube map that lives until :meth:`run`."""
        return self.scratch(
            self._device.create_texture(
                TextureDescriptor(
                    CUBE_FORMAT, size, size, TextureKind.CUBE, levels
                )
            )
        )

    def map_to_cube(
        self,
        map_texture: Handle,
        map_height: int,
        cube: Handle,
        size: int,
        subdivisions: int,
    ) -> None:
        """Resample a map of ``map_height`` rows into level 0 of ``cube``.

        Each texel is the mean of ``subdivisions`` squared samples; of more,
        if it covers several texels of a large map.
        """
        subdivisions = max(subdivisions, -(-map_height // (2 * size)))
        self.cube_level(
            "equirectangular_to_cube.frag",
            {},
            cube,
            0,
            size,
            TextureBinding("environment_map", map_texture, MAP_SAMPLER),
            subdivisions=subdivisions,
        )

    def cube_level(
        self,
        fragment: str,
        defines: dict[str, str | int],
        cube: Handle,
        level: int,
        size: int,
        source: TextureBinding,
        *,
        subdivisions: int = 1,
        samples: bytes = b"",
    ) -> None:
        """Run a pass over the six faces of one level of ``cube``."""
        uniforms = (
            (UniformBinding("PrefilterSamples", self._buffer(samples)),)
            if samples
            else ()
        )
        for face in range(6):
            block = _CUBE_FACE.pack(
                {
                    "face": face,
                    "size": size,
                    "subdivisions": subdivisions,
                }
            )
            faces = UniformBinding("CubeFace", self._buffer(block.tobytes()))
            self.draw(
                fragment,
                defines,
                Attachment(cube, level, face),
                BindGroupDescriptor((source,), (*uniforms, faces)),
            )

    def draw(
        self,
        fragment: str,
        defines: dict[str, str | int],
        target: Attachment,
        bindings: BindGroupDescriptor | None = None,
    ) -> None:
        """Record one pass into ``target``."""
        framebuffer = self._keep(
            self._device.create_framebuffer, FramebufferDescriptor((target,))
        )
        group = self._keep(
            self._device.create_bind_group, bindings or BindGroupDescriptor()
        )
        buffer = self._commands.command_buffer()
        buffer.bind_framebuffer(framebuffer)
        buffer.draw(
            self._passes.program(fragment, defines),
            self._passes.triangle,
            group,
            FULLSCREEN,
        )

    def run(self) -> None:
        """Submit the passes and let go of what only they needed."""
        self._device.submit(
            self._commands, sort=False, stage="environment", paced=False
        )
        # Users of a resource go before it.
        self._device.destroy(*reversed(self._scratch))

    def _buffer(self, data: bytes) -> Handle:
        return self._keep(
            lambda descriptor: self._device.create_buffer(descriptor, data),
            BufferDescriptor(BufferUsage.UNIFORM, len(data)),
        )

    def _keep(self, create: Callable[[Any], Handle], descriptor: Any) -> Handle:
        return self.scratch(create(descriptor))
