"""Lighting at single points: any normal, view and material, by the shaders.

What a picture shows of a surface, without geometry and rasterisation, which
would add errors of their own. The environment goes through the renderer's
own light sources.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    PixelFormat,
    ProgramDescriptor,
    TextureBinding,
    TextureDescriptor,
    UniformBinding,
)
from moka.commands.handles import Handle
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FULLSCREEN, FullscreenPasses
from moka.graphics.shader_source import load_shader, preprocess_shader
from moka.lighting.brdf_table import TABLE_SAMPLER
from moka.lighting.environment import Environment
from moka.lighting.environment_maps import CUBE_SAMPLER
from moka.material.description import Feature
from moka.renderer.frame_block import FRAME
from moka.renderer.light_sources import LightSources, light_capacity
from moka.renderer.map_needs import MapNeeds
from moka.renderer.permutation import LightingDescription, lights_layout
from moka.scene.scene import Scene

__all__ = ["LightingProbe"]

_WIDTH = 256

_FRAGMENT = """
const vec3 surface_position = vec3(0.0);

#include "include/lighting.glsl"

uniform sampler2D normals;    // a is roughness
uniform sampler2D views;      // a is metalness
uniform sampler2D colours;

out vec4 radiance;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec4 normal = texelFetch(normals, place, 0);
    vec4 view = texelFetch(views, place, 0);
    Surface surface = make_surface(
        texelFetch(colours, place, 0).rgb, view.a, normal.a, 1.0,
        normal.rgb, view.rgb);
    vec3 light = vec3(0.0);
#ifdef MOKA_ENVIRONMENT
    light += environment_light(surface);
#endif
#ifdef MOKA_PUNCTUAL_LIGHTS
    light += punctual_light(surface);
#endif
    radiance = vec4(light, 1.0);
}
"""


class LightingProbe:
    """Points under one environment; ``options`` are RenderSettings'."""

    def __init__(
        self,
        device: GraphicsDevice,
        environment: Environment,
        *,
        suns: str | int = "auto",
        irradiance: str = "auto",
        brdf: str = "gltf",
        diffuse: str = "lambert",
        multiscatter: bool = False,
        rotation: float = 0.0,
        ibl: str = "split-sum",
        ibl_samples: int = 16,
        reflections: str = "full",
    ) -> None:
        self._device = device
        self._passes = FullscreenPasses(device)
        self.statistics = Statistics()
        sources = LightSources(device, self._passes, self.statistics)
        sources.update_maps(
            environment,
            MapNeeds(
                background=False,
                specular=True,
                irradiance=True,
                suns=suns,
                irradiance_as=irradiance,
                ibl=ibl,
                reflections=reflections,
            ),
        )
        sources.maps.fill()
        scene = Scene()
        scene.environment = environment
        scene.environment_rotation = rotation
        lights = sources.rows(scene, np.zeros(3))
        capacity = light_capacity(len(lights))
        lighting = LightingDescription(
            True,
            capacity,
            brdf,
            diffuse,
            multiscatter,
            float_target=True,
            harmonics=sources.harmonics is not None,
            ibl=ibl,
        )
        frame = {
            "environment_turn": (math.cos(rotation), math.sin(rotation)),
            "environment_intensity": 1.0,
            "specular_levels": sources.maps.specular_levels - 1,
            "light_count": len(lights),
            "sample_range": (0, ibl_samples, 0, 0),
        }
        if sources.harmonics is not None:
            frame["irradiance_harmonics"] = sources.harmonics
        blocks = FRAME.glsl
        self._uniforms = [self._uniform("Frame", FRAME.pack(frame))]
        if capacity:
            layout = lights_layout(capacity)
            data = np.zeros(layout.size, np.uint8)
            data[: lights.nbytes] = lights.view(np.uint8)
            blocks += layout.glsl
            self._uniforms.append(self._uniform("Lights", data))
        self._textures = [
            TextureBinding(name, handle, sampler)
            for name, handle, sampler in (
                ("specular_cube", sources.maps.specular, CUBE_SAMPLER),
                ("irradiance_cube", sources.maps.irradiance, CUBE_SAMPLER),
                ("radiance_cube", sources.maps.radiance, CUBE_SAMPLER),
                ("brdf_table", sources.table(brdf), TABLE_SAMPLER),
            )
            if handle is not None
        ]
        defines: dict[str, Any] = lighting.defines(Feature.DIFFUSE)
        self._program = device.create_program(
            ProgramDescriptor(
                load_shader("fullscreen.vert"),
                preprocess_shader(_FRAGMENT, defines, injected=blocks),
            ),
            wait=True,
        )

    def shade(
        self,
        normals: ArrayLike,
        views: ArrayLike,
        roughness: ArrayLike,
        *,
        colour: ArrayLike = (1.0, 1.0, 1.0),
        metalness: ArrayLike = 1.0,
    ) -> NDArray[np.float32]:
        """Radiance (N, 3) towards ``views`` (N, 3) of points that face
        ``normals`` (N, 3); the others are given once or (N, ...)."""
        count = max(
            len(np.atleast_2d(normals)),
            len(np.atleast_2d(views)),
            np.size(roughness),
        )
        height = -(-count // _WIDTH)
        textures = [
            self._texture(name, height, count, vectors, scalars)
            for name, vectors, scalars in (
                ("normals", normals, roughness),
                ("views", views, metalness),
                ("colours", colour, 0.0),
            )
        ]
        target = self._device.create_texture(
            TextureDescriptor(PixelFormat.RGBA32F, _WIDTH, height)
        )
        framebuffer = self._device.create_framebuffer(
            FramebufferDescriptor((Attachment(target),))
        )
        group = self._device.create_bind_group(
            BindGroupDescriptor(
                (*self._textures, *textures), tuple(self._uniforms)
            )
        )
        commands = CommandList()
        commands.bind_framebuffer(framebuffer)
        commands.draw(self._program, self._passes.triangle, group, FULLSCREEN)
        pixels = commands.read_pixels(framebuffer, (0, 0, _WIDTH, height))
        self._device.submit(commands, sort=False).wait()
        self._device.destroy(
            group,
            framebuffer,
            target,
            *(binding.texture for binding in textures),
        )
        assert pixels.data is not None
        return pixels.data.reshape(-1, 4)[:count, :3]

    def _texture(
        self,
        name: str,
        height: int,
        count: int,
        vectors: ArrayLike,
        scalars: ArrayLike,
    ) -> TextureBinding:
        texels = np.zeros((height * _WIDTH, 4), np.float32)
        texels[:count, :3] = vectors
        texels[:count, 3] = scalars
        return TextureBinding(
            name,
            self._device.create_texture(
                TextureDescriptor(PixelFormat.RGBA32F, _WIDTH, height),
                [texels.reshape(height, _WIDTH, 4)],
            ),
        )

    def _uniform(self, name: str, data: NDArray[Any]) -> UniformBinding:
        buffer: Handle = self._device.create_buffer(
            BufferDescriptor(BufferUsage.UNIFORM, data.nbytes), data
        )
        return UniformBinding(name, buffer)
