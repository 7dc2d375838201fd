"""Materials as glTF 2.0 describes them: factors, textures, alpha mode.

A material here is what the file says. What a shader needs to know of it is
its description (:mod:`moka.material.description`), what the GPU reads of it
is its parameter row (:mod:`moka.material.parameters`).
"""

from enum import Enum

from msgspec import Struct

from moka.commands.descriptors import SamplerDescriptor
from moka.core.encoded_image import EncodedImage

__all__ = ["AlphaMode", "Material", "Texture", "TextureTransform"]


class AlphaMode(Enum):
    """How the alpha of the base colour is used (glTF 2.0, 3.9.4)."""

    OPAQUE = "OPAQUE"
    MASK = "MASK"
    BLEND = "BLEND"


class TextureTransform(Struct, frozen=True):
    """KHR_texture_transform: uv' = translation * rotation * scale * uv.

    ``rotation`` is counter-clockwise in radians as the extension defines it.
    """

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, float] = (1.0, 1.0)


class Texture(Struct, frozen=True):
    """An image, how it is sampled, and with which texture coordinates."""

    image: EncodedImage
    sampler: SamplerDescriptor = SamplerDescriptor()
    uv_set: int = 0
    transform: TextureTransform | None = None


class Material(Struct, frozen=True, eq=False):
    """A metallic-roughness material of glTF 2.0.

    Factors are linear Rec.709; ``emissive_factor`` already holds the
    strength of KHR_materials_emissive_strength. Base colour and emissive
    textures are sRGB-encoded, the others are data: metalness is blue and
    roughness green of one texture, occlusion is red. ``animated`` names what
    animations change of it, such as ``normal_texture.offset``. ``coarser``
    are the levels of detail below this one, ``limits`` the least parts of
    the picture at which it and each of them is drawn (MSFT_lod).

    ``ior``, the index of refraction (0 for a reflectance of 1), is of
    KHR_materials_ior. Of KHR_materials_specular, the reflectance of a
    dielectric is multiplied by ``specular_colour_factor``, which may exceed
    1, head-on, and by ``specular_factor`` at all angles; their textures are
    sRGB-encoded colour, and data in alpha.
    """

    name: str = ""
    base_colour_factor: tuple[float, float, float, float] = (1, 1, 1, 1)
    metallic_factor: float = 1.0
    roughness_factor: float = 1.0
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    emissive_factor: tuple[float, float, float] = (0, 0, 0)
    ior: float = 1.5
    specular_factor: float = 1.0
    specular_colour_factor: tuple[float, float, float] = (1, 1, 1)
    base_colour_texture: Texture | None = None
    metallic_roughness_texture: Texture | None = None
    normal_texture: Texture | None = None
    occlusion_texture: Texture | None = None
    emissive_texture: Texture | None = None
    specular_texture: Texture | None = None
    specular_colour_texture: Texture | None = None
    alpha_mode: AlphaMode = AlphaMode.OPAQUE
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    animated: frozenset[str] = frozenset()
    coarser: "tuple[Material, ...]" = ()
    limits: tuple[float, ...] = ()

    @property
    def textures(self) -> tuple[Texture, ...]:
        """Its textures, whether or not they change the picture."""
        return tuple(
            texture
            for texture in (
                self.base_colour_texture,
                self.metallic_roughness_texture,
                self.normal_texture,
                self.occlusion_texture,
                self.emissive_texture,
                self.specular_texture,
                self.specular_colour_texture,
            )
            if texture is not None
        )
