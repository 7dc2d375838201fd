"""The uniform block that every surface of a frame shares."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)

if TYPE_CHECKING:
    from moka.renderer.view import View
    from moka.scene.scene import Scene

__all__ = ["FRAME", "frame_values"]

# Lines are as wide as this part of the picture's height, points are squares
# of the other one; a pixel at least.
_LINE_WIDTH = 1 / 720
_POINT_SIZE = 1 / 360

# What the whole frame shares. World space has its origin at the camera, so
# that positions a million metres from zero keep their detail.
FRAME = UniformLayout(
    "Frame",
    (
        Parameter("clip_from_world", ParameterType.MAT4),
        # Towards the viewer from p: xyz - p * w. Perspective is (0, 0, 0, 1).
        Parameter("eye", ParameterType.VEC4),
        # Cosine and sine of the environment's rotation about +Y.
        Parameter("environment_turn", ParameterType.VEC2),
        Parameter("environment_intensity", ParameterType.FLOAT),
        # Of the environment's E / pi, with MOKA_IRRADIANCE_SH.
        Parameter("irradiance_harmonics", ParameterType.VEC3, 9),
        # The level of the specular cube for roughness 1.
        Parameter("specular_levels", ParameterType.FLOAT),
        Parameter("light_count", ParameterType.INT),
        # Width and height in pixels, and of what is drawn as lines or points.
        Parameter("picture_size", ParameterType.VEC2),
        Parameter("line_width", ParameterType.FLOAT),
        Parameter("point_size", ParameterType.FLOAT),
        # With MOKA_LOGARITHMIC_DEPTH: View.depth_range.
        Parameter("depth_range", ParameterType.VEC3),
        # Of reference lighting: x the first sample of the frame, y how many,
        # z the number of the batch.
        Parameter("sample_range", ParameterType.IVEC4),
        # Of numbers in a visibility buffer, those that count triangles.
        Parameter("triangle_bits", ParameterType.INT),
    ),
)


def frame_values(
    scene: "Scene",
    view: "View",
    size: tuple[int, int],
    *,
    harmonics: NDArray[np.float64] | None = None,
    specular_levels: int = 1,
    light_count: int = 0,
    sample_range: tuple[int, int, int, int] = (0, 0, 0, 0),
    triangle_bits: int = 0,
) -> NDArray[np.void]:
    """The block for ``scene`` seen by ``view`` in a picture of ``size``.

    The rest is for what is lit: ``harmonics`` (9, 3) are those of irradiance,
    if it comes from them, ``sample_range`` is the parameter of that name.
    """
    rotation = scene.environment_rotation
    height = size[1]
    return FRAME.pack(
        {
            "irradiance_harmonics": (
                np.zeros((9, 3)) if harmonics is None else harmonics
            ),
            "clip_from_world": view.clip_from_world,
            "eye": view.eye,
            "environment_turn": (math.cos(rotation), math.sin(rotation)),
            "environment_intensity": scene.environment_intensity,
            "specular_levels": specular_levels - 1,
            "light_count": light_count,
            "picture_size": size,
            "line_width": max(1.0, height * _LINE_WIDTH),
            "point_size": max(1.0, height * _POINT_SIZE),
            "depth_range": view.depth_range or (0.0, 0.0, 0.0),
            "sample_range": sample_range,
            "triangle_bits": triangle_bits,
        }
    )
