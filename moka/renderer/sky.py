"""The environment as one camera sees it, behind a scene."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from msgspec.structs import replace

from moka.commands.descriptors import TextureBinding
from moka.commands.handles import Handle
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.lighting.environment import Sun
from moka.lighting.environment_maps import CUBE_SAMPLER, MAP_SAMPLER
from moka.renderer.view import View

__all__ = ["MOST_DISCS", "Sky", "background_layout"]

#: Discs of suns that a sky shows; a map may show any number.
MOST_DISCS = 64


@cache
def background_layout(discs: int) -> UniformLayout:
    """The block ``Background`` of a sky that shows so many ``discs``."""
    parameters = [
        Parameter("direction_from_clip", ParameterType.MAT4),
        Parameter("parameters", ParameterType.VEC4),
    ]
    if discs:
        parameters += [
            Parameter("sun_discs", ParameterType.VEC4, discs),
            Parameter("sun_radiances", ParameterType.VEC4, discs),
        ]
    return UniformLayout("Background", tuple(parameters))


class Sky:
    """What is seen of an environment by one camera.

    ``rotation`` is in radians about +Y; a ``float_target`` can hold any
    radiance, others what half floats can. ``suns`` are drawn as discs, the
    first 64 of them, with edges for a picture of ``height`` pixels; they are
    not in the map. With ``cube``, prefiltered in so many ``levels``, it is
    seen as a surface of roughness ``blur`` reflects it.
    """

    def __init__(
        self,
        environment_map: Handle,
        view: View,
        *,
        rotation: float,
        intensity: float,
        float_target: bool,
        suns: Sequence[Sun] = (),
        height: int = 1,
        cube: Handle | None = None,
        levels: int = 1,
        blur: float = 0.0,
    ) -> None:
        self.binding = TextureBinding(
            "environment_map", environment_map, MAP_SAMPLER
        )
        self.defines = {"MOKA_SKY": 1}
        if float_target:
            self.defines["MOKA_FLOAT_TARGET"] = 1
        level = angle = 0.0
        if cube is not None:
            self.defines["MOKA_BLURRED_SKY"] = 1
            self.binding = TextureBinding("specular_cube", cube, CUBE_SAMPLER)
            # As lighting.glsl has specular_level and sun_weight; the angle
            # is the width of such a lobe.
            level = (levels - 1) * blur * (2.0 - blur)
            if level < 1.0:
                level = level**4 * (3.0 - 2.0 * level**2)
            suns = [
                replace(sun, irradiance=_scaled(sun.irradiance, level))
                if sun.in_map and level < 1.0
                else sun
                for sun in suns
            ]
            angle = blur**2
        values: dict[str, Any] = {
            "direction_from_clip": view.direction_from_clip(rotation),
            "parameters": (intensity, level, 2.0 / height, angle),
        }
        suns = suns[:MOST_DISCS]
        if suns:
            self.defines["MOKA_SUN_DISCS"] = len(suns)
            # A point would have no radiance that could be drawn.
            radii = [max(sun.angular_radius, 1e-5) for sun in suns]
            values["sun_discs"] = [
                (*sun.direction, radius)
                for sun, radius in zip(suns, radii, strict=True)
            ]
            values["sun_radiances"] = [
                (*np.divide(sun.irradiance, math.pi * math.sin(radius) ** 2), 0)
                for sun, radius in zip(suns, radii, strict=True)
            ]
        self.block = background_layout(len(suns)).pack(values)


def _scaled(
    irradiance: tuple[float, float, float], by: float
) -> tuple[float, float, float]:
    red, green, blue = irradiance
    return by * red, by * green, by * blue
