"""A material's numbers as the row that the GPU reads.

Rows of all materials lie in one uniform buffer, so that draws of many
materials and one program can be one call: the vertex shader hands the row's
number on to the fragment shader.
"""

import math
from enum import IntFlag, auto
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.material.material import Material, TextureTransform

__all__ = ["RowPart", "material_layout", "material_values", "uv_matrix"]


class RowPart(IntFlag):
    """What is in the rows of those materials only that need it."""

    TRANSFORMS = auto()  # of KHR_texture_transform
    SPECULAR = auto()  # of KHR_materials_ior and KHR_materials_specular


_NO_PARTS = RowPart(0)

_SLOTS = (
    "base_colour",
    "metallic_roughness",
    "normal",
    "occlusion",
    "emissive",
)
_SPECULAR_SLOTS = ("specular", "specular_colour")

_FACTORS = (
    Parameter("base_colour_factor", ParameterType.VEC4),
    Parameter("emissive_factor", ParameterType.VEC3),
    Parameter("alpha_cutoff", ParameterType.FLOAT),
    Parameter("metallic_factor", ParameterType.FLOAT),
    Parameter("roughness_factor", ParameterType.FLOAT),
    Parameter("normal_scale", ParameterType.FLOAT),
    Parameter("occlusion_strength", ParameterType.FLOAT),
)
_SPECULAR = (
    # Before textures, the limit of 1 and the factor.
    Parameter("dielectric_f0", ParameterType.VEC3),
    Parameter("specular_factor", ParameterType.FLOAT),
)


def material_layout(rows: int, parts: RowPart = _NO_PARTS) -> UniformLayout:
    """The block ``Materials`` of ``rows`` rows.

    Only materials that have an extension pay for its ``parts``.
    """
    # The upper two rows of each 2D affine matrix; w is unused.
    transforms = (
        Parameter(f"{slot}_transform", ParameterType.VEC4, 2)
        for slot in _transformed_slots(parts)
    )
    specular = _SPECULAR if RowPart.SPECULAR in parts else ()
    return UniformLayout("Materials", (*_FACTORS, *specular, *transforms), rows)


def material_values(
    material: Material, parts: RowPart = _NO_PARTS
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
    if RowPart.SPECULAR in parts:
        f0 = ((material.ior - 1.0) / (material.ior + 1.0)) ** 2
        values["dielectric_f0"] = tuple(
            f0 * factor for factor in material.specular_colour_factor
        )
        values["specular_factor"] = material.specular_factor
    for slot in _transformed_slots(parts):
        texture = getattr(material, f"{slot}_texture")
        transform = texture.transform if texture else None
        matrix = np.zeros((2, 4))
        matrix[:, :3] = uv_matrix(transform or TextureTransform())
        values[f"{slot}_transform"] = matrix
    return values


def _transformed_slots(parts: RowPart) -> tuple[str, ...]:
    if RowPart.TRANSFORMS not in parts:
        return ()
    return (*_SLOTS, *_SPECULAR_SLOTS) if RowPart.SPECULAR in parts else _SLOTS


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
