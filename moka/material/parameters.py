"""A material's numbers as the row that the GPU reads.

Rows of all materials lie in one uniform buffer, so that draws of many
materials and one program can be one call: the vertex shader hands the row's
number on to the fragment shader.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.material.material import Material, TextureTransform

__all__ = ["material_layout", "material_values", "uv_matrix"]

_SLOTS = (
    "base_colour",
    "metallic_roughness",
    "normal",
    "occlusion",
    "emissive",
)

_FACTORS = (
    Parameter("base_colour_factor", ParameterType.VEC4),
    Parameter("emissive_factor", ParameterType.VEC3),
    Parameter("alpha_cutoff", ParameterType.FLOAT),
    Parameter("metallic_factor", ParameterType.FLOAT),
    Parameter("roughness_factor", ParameterType.FLOAT),
    Parameter("normal_scale", ParameterType.FLOAT),
    Parameter("occlusion_strength", ParameterType.FLOAT),
)
# The upper two rows of each 2D affine matrix; w is unused.
_TRANSFORMS = tuple(
    Parameter(f"{slot}_transform", ParameterType.VEC4, 2) for slot in _SLOTS
)


def material_layout(rows: int, *, has_transforms: bool) -> UniformLayout:
    """The block ``Materials`` of ``rows`` rows.

    Only materials with KHR_texture_transform pay for its matrices.
    """
    transforms = _TRANSFORMS if has_transforms else ()
    return UniformLayout("Materials", (*_FACTORS, *transforms), rows)


def material_values(
    material: Material, *, has_transforms: bool
) -> dict[str, Any]:
    """The values of one row, by parameter name."""
    values: dict[str, Any] = {
        "base_colour_factor": material.base_colour_factor,
        "emissive_factor": material.emissive_factor,
        "alpha_cutoff": material.alpha_cutoff,
        "metallic_factor": material.metallic_factor,
        "roughness_factor": material.roughness_factor,
        "normal_scale": material.normal_scale,
        "occlusion_strength": material.occlusion_strength,
    }
    if has_transforms:
        for slot in _SLOTS:
            texture = getattr(material, f"{slot}_texture")
            transform = texture.transform if texture else None
            matrix = np.zeros((2, 4))
            matrix[:, :3] = uv_matrix(transform or TextureTransform())
            values[f"{slot}_transform"] = matrix
    return values


def uv_matrix(transform: TextureTransform) -> NDArray[np.float64]:
    """The 2x3 matrix of KHR_texture_transform: T * R * S.

    A positive rotation turns the coordinates counter-clockwise in a space
    whose v points down, as the extension's own matrices have it.
    """
    cosine, sine = math.cos(transform.rotation), math.sin(transform.rotation)
    (scale_u, scale_v), (offset_u, offset_v) = transform.scale, transform.offset
    return np.array(
        [
            [cosine * scale_u, sine * scale_v, offset_u],
            [-sine * scale_u, cosine * scale_v, offset_v],
        ]
    )
