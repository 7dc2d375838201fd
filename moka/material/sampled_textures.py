"""Which textures of a material are sampled, and which of them together."""

from moka.core.encoded_image import EncodedImage
from moka.core.image_header import (
    has_deep_texels,
    image_media_type,
    pixel_size,
)
from moka.material.material import AlphaMode, Material, Texture

__all__ = [
    "SPECULAR_FACTORS",
    "can_glow",
    "carriers_of",
    "moves",
    "share_sample",
    "texture_slots",
]

#: The factors of KHR_materials_ior and KHR_materials_specular.
SPECULAR_FACTORS = frozenset(
    ("ior", "specular_factor", "specular_colour_factor")
)


def texture_slots(material: Material) -> dict[str, Texture]:
    """The textures that can change the picture, by slot, in fixed order.

    Those of a factor of 0 cannot, unless animations change it.
    """
    animated = material.animated
    slots = {
        "base_colour": material.base_colour_texture,
        "metallic_roughness": material.metallic_roughness_texture,
        "normal": (
            material.normal_texture
            if material.normal_scale or "normal_scale" in animated
            else None
        ),
        "occlusion": (
            material.occlusion_texture
            if material.occlusion_strength or "occlusion_strength" in animated
            else None
        ),
        "emissive": (material.emissive_texture if can_glow(material) else None),
        "specular": (
            material.specular_texture
            if material.specular_factor or "specular_factor" in animated
            else None
        ),
        "specular_colour": (
            material.specular_colour_texture if _can_tint(material) else None
        ),
    }
    return {slot: texture for slot, texture in slots.items() if texture}


def moves(material: Material, *slots: str) -> bool:
    """Whether animations move the texture coordinates of any of ``slots``."""
    return any(
        name.partition("_texture.")[0] in slots
        for name in material.animated
        if "." in name
    )


def can_glow(material: Material) -> bool:
    """Whether the emissive factor is, or may become, more than black."""
    return any(material.emissive_factor) or bool(
        material.animated & {"emissive_factor", "emissive_strength"}
    )


def carriers_of(
    material: Material, slots: dict[str, Texture]
) -> dict[str, str]:
    """Slots with an alpha to spare for what roughness and others say.

    All of it, or there would still be that texture to sample. Only opaque
    materials do not read the alpha of their colour.
    """
    surface = slots.get("metallic_roughness")
    if surface is None or not _is_carried(surface, surface):
        return {}
    values = ["roughness", "metalness"]
    occlusion = slots.get("occlusion")
    if occlusion is not None and _is_carried(occlusion, surface):
        values.append("occlusion")
    spare = ["normal", "base_colour", "emissive"]
    if material.alpha_mode is not AlphaMode.OPAQUE:
        spare.remove("base_colour")
    carriers = [
        slot
        for slot in spare
        if slot in slots and _is_carried(surface, slots[slot])
    ]
    if len(carriers) < len(values):
        return {}
    return dict(zip(values, carriers, strict=False))


def share_sample(first: Texture | None, second: Texture | None) -> bool:
    """Whether both can be read from one sample of one texture.

    They are one image already, or of one size and can be put together.
    """
    return (
        first is not None
        and second is not None
        and first.sampler == second.sampler
        and first.uv_set == second.uv_set
        and first.transform == second.transform
        and (
            first.image.identity == second.image.identity
            or _can_be_joined(first.image, second.image)
        )
    )


def _can_tint(material: Material) -> bool:
    """Whether a dielectric reflects, or may reflect, anything head-on."""
    return not material.animated.isdisjoint(SPECULAR_FACTORS) or bool(
        material.ior != 1
        and material.specular_factor
        and any(material.specular_colour_factor)
    )


def _is_carried(first: Texture, second: Texture) -> bool:
    """Whether an alpha of one could be a channel of the other.

    Alphas have 8 bits where colours are encoded.
    """
    return (
        first.sampler == second.sampler
        and first.uv_set == second.uv_set
        and first.transform is None is second.transform
        and _can_be_joined(first.image, second.image)
        and not has_deep_texels(first.image)
        and not has_deep_texels(second.image)
    )


def _can_be_joined(first: EncodedImage, second: EncodedImage) -> bool:
    """Whether channels of both can stand in one texture.

    KTX2 images stay alone, since they keep their blocks and their levels.
    """
    return pixel_size(first) == pixel_size(second) is not None and (
        "image/ktx2" not in (image_media_type(first), image_media_type(second))
    )
