"""Materials, what shaders must know of them, and what the GPU reads."""

from moka.material.description import (
    Feature,
    MaterialDescription,
    defines_of,
    describe_material,
)
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)

__all__ = [
    "AlphaMode",
    "Feature",
    "Material",
    "MaterialDescription",
    "Texture",
    "TextureTransform",
    "defines_of",
    "describe_material",
]
