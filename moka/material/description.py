"""What a shader must know of a material: a value, independent of GL.

While a model is prepared for drawing, each primitive's material and vertex
attributes become a description; descriptions are the keys of the table of
loaded programs (the report's "hash of the material description", without
the hash: the value itself is the key, so two descriptions never collide).
:func:`defines_of` is the one place that turns it into ``#define``s.
"""

from collections.abc import Collection
from enum import IntFlag, auto

from msgspec import Struct

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.core.image_header import has_deep_texels, pixel_size
from moka.material.material import AlphaMode, Material, Texture

__all__ = [
    "Feature",
    "MaterialDescription",
    "TextureUse",
    "defines_of",
    "describe_material",
    "texture_slots",
]


class Feature(IntFlag):
    """What a surface shader is compiled with."""

    VERTEX_NORMAL = auto()
    VERTEX_TANGENT = auto()
    VERTEX_COLOUR = auto()
    UV_0 = auto()
    UV_1 = auto()
    ALPHA_MASK = auto()
    ALPHA_BLEND = auto()
    DOUBLE_SIDED = auto()
    UNLIT = auto()
    # Not a pure metal: some light enters the surface and is scattered.
    DIFFUSE = auto()
    EMISSIVE = auto()
    # Roughness, metalness and occlusion come from one sample of one texture,
    # as the file has it or put together while decoding.
    PACKED_OCCLUSION = auto()
    POINTS = auto()


class TextureUse(Struct, frozen=True):
    """That a slot has a texture, and how its coordinates are made."""

    slot: str
    uv_set: int
    has_transform: bool


class MaterialDescription(Struct, frozen=True):
    """Everything about a material that changes the shader's text.

    ``carriers`` are pairs of a value, which is ``roughness``, ``metalness``
    or ``occlusion``, and the slot in whose alpha it is read: one texture
    less to be sampled. Then ``textures`` lacks those that they come from.
    """

    features: Feature
    textures: tuple[TextureUse, ...] = ()
    carriers: tuple[tuple[str, str], ...] = ()

    @property
    def is_blended(self) -> bool:
        """Whether draws are composited back to front."""
        return Feature.ALPHA_BLEND in self.features

    @property
    def attributes(self) -> tuple[str, ...]:
        """The glTF vertex attributes that the shader reads."""
        wanted = {
            "NORMAL": Feature.VERTEX_NORMAL,
            "TANGENT": Feature.VERTEX_TANGENT,
            "TEXCOORD_0": Feature.UV_0,
            "TEXCOORD_1": Feature.UV_1,
            "COLOR_0": Feature.VERTEX_COLOUR,
        }
        return (
            "POSITION",
            *(name for name, flag in wanted.items() if flag in self.features),
        )


def describe_material(
    material: Material,
    attributes: Collection[str],
    topology: Topology = Topology.TRIANGLES,
    *,
    carries: bool = True,
) -> MaterialDescription:
    """The description of ``material`` on vertices with ``attributes``.

    Only what changes the picture is kept: a normal map means nothing to an
    unlit surface or without texture coordinates, an emissive texture
    nothing under a black factor, a tangent nothing without a normal map.
    Unless it ``carries``, no texture takes up the values of another.
    Raises ModelError for a texture coordinate set above 1.
    """
    slots = texture_slots(material)
    features = Feature(0)
    if material.unlit:
        features |= Feature.UNLIT
        slots = {k: v for k, v in slots.items() if k == "base_colour"}
    else:
        if any(material.emissive_factor):
            features |= Feature.EMISSIVE
        if material.metallic_factor < 1 or "metallic_roughness" in slots:
            features |= Feature.DIFFUSE
    slots = {
        slot: texture
        for slot, texture in slots.items()
        if _uv_attribute(material, slot, texture) in attributes
    }
    carriers = _carriers(material, slots) if carries else {}
    if carriers:
        del slots["metallic_roughness"]
    if "occlusion" in carriers:
        del slots["occlusion"]
    if _shares_sample(slots.get("occlusion"), slots.get("metallic_roughness")):
        del slots["occlusion"]
        features |= Feature.PACKED_OCCLUSION
    for texture in slots.values():
        features |= Feature.UV_1 if texture.uv_set else Feature.UV_0
    if not material.unlit and "NORMAL" in attributes:
        features |= Feature.VERTEX_NORMAL
        if "normal" in slots and "TANGENT" in attributes:
            features |= Feature.VERTEX_TANGENT
    if "COLOR_0" in attributes:
        features |= Feature.VERTEX_COLOUR
    if material.double_sided:
        features |= Feature.DOUBLE_SIDED
    if topology is Topology.POINTS:
        features |= Feature.POINTS
    features |= {
        AlphaMode.OPAQUE: Feature(0),
        AlphaMode.MASK: Feature.ALPHA_MASK,
        AlphaMode.BLEND: Feature.ALPHA_BLEND,
    }[material.alpha_mode]
    uses = (
        TextureUse(slot, texture.uv_set, texture.transform is not None)
        for slot, texture in slots.items()
    )
    return MaterialDescription(features, tuple(uses), tuple(carriers.items()))


def texture_slots(material: Material) -> dict[str, Texture]:
    """The textures that can change the picture, by slot, in fixed order."""
    slots = {
        "base_colour": material.base_colour_texture,
        "metallic_roughness": material.metallic_roughness_texture,
        "normal": material.normal_texture if material.normal_scale else None,
        "occlusion": (
            material.occlusion_texture if material.occlusion_strength else None
        ),
        "emissive": (
            material.emissive_texture if any(material.emissive_factor) else None
        ),
    }
    return {slot: texture for slot, texture in slots.items() if texture}


def defines_of(description: MaterialDescription) -> dict[str, str | int]:
    """The ``#define``s that compile the surface shader for it."""
    defines: dict[str, str | int] = {
        f"MOKA_{flag.name}": 1
        for flag in Feature
        if flag in description.features
    }
    for use in description.textures:
        name = f"MOKA_{use.slot.upper()}"
        defines[f"{name}_TEXTURE"] = 1
        defines[f"{name}_UV"] = use.uv_set
        if use.has_transform:
            defines[f"{name}_TRANSFORM"] = 1
    for value, slot in description.carriers:
        defines[f"MOKA_{value.upper()}_CARRIER"] = f"{slot}_texture"
        defines["MOKA_CARRIED_UV"] = defines[f"MOKA_{slot.upper()}_UV"]
    return defines


def _uv_attribute(material: Material, slot: str, texture: Texture) -> str:
    if texture.uv_set > 1:
        raise ModelError(
            f"{texture.image.where}: the {slot.replace('_', ' ')} texture of "
            f"material {material.name!r} uses TEXCOORD_{texture.uv_set}; moka "
            "draws sets 0 and 1"
        )
    return f"TEXCOORD_{texture.uv_set}"


def _carriers(material: Material, slots: dict[str, Texture]) -> dict[str, str]:
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


def _is_carried(first: Texture, second: Texture) -> bool:
    """Whether an alpha of one could be a channel of the other.

    Alphas have 8 bits where colours are encoded.
    """
    return (
        first.sampler == second.sampler
        and first.uv_set == second.uv_set
        and first.transform is None is second.transform
        and pixel_size(first.image) == pixel_size(second.image) is not None
        and not has_deep_texels(first.image)
        and not has_deep_texels(second.image)
    )


def _shares_sample(first: Texture | None, second: Texture | None) -> bool:
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
            or pixel_size(first.image) == pixel_size(second.image) is not None
        )
    )
