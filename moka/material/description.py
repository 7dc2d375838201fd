"""What a shader must know of a material: a value, independent of GL.

While a model is prepared for drawing, each primitive's material and vertex
attributes become a description; descriptions are the keys of the table of
loaded programs (the report's "hash of the material description", without
the hash: the value itself is the key, so two descriptions never collide).
:func:`defines_of` is the one place that turns it into ``#define``s.
"""

from collections.abc import Collection
from enum import IntFlag, auto
from itertools import chain

from msgspec import Struct
from msgspec.structs import replace

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.material.material import AlphaMode, Material, Texture
from moka.material.sampled_textures import (
    SPECULAR_FACTORS,
    can_glow,
    carriers_of,
    moves,
    share_sample,
    texture_slots,
)

__all__ = [
    "MORPH_TEXELS",
    "Feature",
    "MaterialDescription",
    "TextureUse",
    "defines_of",
    "describe_material",
    "morph_texels",
]


_SPECULAR_SLOTS = frozenset(("specular", "specular_colour"))
_POINTS_AND_LINES = frozenset(
    (
        Topology.POINTS,
        Topology.LINES,
        Topology.LINE_LOOP,
        Topology.LINE_STRIP,
    )
)


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
    # Segments as quads.
    LINES = auto()
    # The alpha of the normal map says what its levels average.
    NORMAL_VARIANCE = auto()
    # A dielectric of another reflectance than glTF's 0.04.
    SPECULAR = auto()


# What a morph target adds to a vertex, in texels of four numbers: which
# attributes share one. All coordinates of textures do.
MORPH_TEXELS: dict[str, tuple[str, ...]] = {
    "POSITION": ("POSITION",),
    "NORMAL": ("NORMAL",),
    "TANGENT": ("TANGENT",),
    "UV": ("TEXCOORD_0", "TEXCOORD_1"),
    "COLOUR": ("COLOR_0",),
}


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
    # Sets of four joints that vertices follow.
    influence_sets: int = 0
    # The attributes that morph targets change, in the order of MORPH_TEXELS.
    morphed: tuple[str, ...] = ()
    # The set of coordinates to make tangents for, -1 if the mesh has them.
    tangents_of: int = -1

    @property
    def deforms(self) -> bool:
        """Whether vertices move within the object."""
        return bool(self.influence_sets or self.morphed)

    @property
    def is_blended(self) -> bool:
        """Whether draws are composited back to front."""
        return Feature.ALPHA_BLEND in self.features

    @property
    def attributes(self) -> tuple[str, ...]:
        """The vertex attributes that the shader reads, by glTF's names.

        Corners of lines have LINE_OTHER besides. Tangents that are made are
        called TANGENT_OF_UV_0 or 1.
        """
        made = self.tangents_of >= 0
        tangent = f"TANGENT_OF_UV_{self.tangents_of}" if made else "TANGENT"
        wanted = {
            "NORMAL": Feature.VERTEX_NORMAL,
            tangent: Feature.VERTEX_TANGENT,
            "TEXCOORD_0": Feature.UV_0,
            "TEXCOORD_1": Feature.UV_1,
            "COLOR_0": Feature.VERTEX_COLOUR,
            "LINE_OTHER": Feature.LINES,
        }
        return (
            "POSITION",
            *(name for name, flag in wanted.items() if flag in self.features),
            *(
                f"{name}_{number}"
                for number in range(self.influence_sets)
                for name in ("JOINTS", "WEIGHTS")
            ),
        )


def describe_material(
    material: Material,
    attributes: Collection[str],
    topology: Topology = Topology.TRIANGLES,
    *,
    morphed: Collection[str] = (),
    carries: bool = True,
) -> MaterialDescription:
    """The description of ``material`` on vertices with ``attributes``.

    ``morphed`` are the attributes that morph targets change. Only what
    changes the picture is kept: a normal map means nothing to an unlit
    surface or without texture coordinates, an emissive texture nothing
    under a black factor, a tangent nothing without a normal map. Points and
    lines without normals show base colour and emission, and have no normal
    map without tangents (glTF 2.0, section 3.9.7); surfaces without tangents
    get them for a normal map (3.7.2.1). What animations change is described
    so that every value can be drawn. Unless it ``carries``, no
    texture takes up the values of another.
    Raises ModelError for a texture coordinate set above 1.
    """
    slots = texture_slots(material)
    features = Feature(0)
    is_surface = topology not in _POINTS_AND_LINES
    unlit = material.unlit or not (is_surface or "NORMAL" in attributes)
    if not is_surface and "TANGENT" not in attributes:
        slots.pop("normal", None)
    if material.unlit:
        features |= Feature.UNLIT
        slots = {k: v for k, v in slots.items() if k == "base_colour"}
    elif unlit:
        features |= Feature.UNLIT
        if can_glow(material):
            features |= Feature.EMISSIVE
        slots = {
            k: v for k, v in slots.items() if k in ("base_colour", "emissive")
        }
    else:
        if can_glow(material):
            features |= Feature.EMISSIVE
        if (
            material.metallic_factor < 1
            or "metallic_factor" in material.animated
            or "metallic_roughness" in slots
        ):
            features |= Feature.DIFFUSE
    if Feature.DIFFUSE not in features:
        # Metals have no dielectric interface.
        slots = {k: v for k, v in slots.items() if k not in _SPECULAR_SLOTS}
    slots = {
        slot: texture
        for slot, texture in slots.items()
        if _uv_attribute(material, slot, texture) in attributes
    }
    if Feature.DIFFUSE in features and (
        _has_specular_factors(material) or not _SPECULAR_SLOTS.isdisjoint(slots)
    ):
        features |= Feature.SPECULAR
    carriers = carriers_of(material, slots) if carries else {}
    if carriers:
        del slots["metallic_roughness"]
    if "occlusion" in carriers:
        del slots["occlusion"]
    if share_sample(
        slots.get("occlusion"), slots.get("metallic_roughness")
    ) and not (moves(material, "occlusion", "metallic_roughness")):
        del slots["occlusion"]
        features |= Feature.PACKED_OCCLUSION
    for texture in slots.values():
        features |= Feature.UV_1 if texture.uv_set else Feature.UV_0
    tangents_of = -1
    if not unlit and "NORMAL" in attributes:
        features |= Feature.VERTEX_NORMAL
        if "normal" in slots and "TANGENT" in attributes:
            features |= Feature.VERTEX_TANGENT
        elif "normal" in slots and _wants_tangents(slots["normal"], morphed):
            features |= Feature.VERTEX_TANGENT
            tangents_of = slots["normal"].uv_set
    if "COLOR_0" in attributes:
        features |= Feature.VERTEX_COLOUR
    if material.double_sided:
        features |= Feature.DOUBLE_SIDED
    if topology is Topology.POINTS:
        features |= Feature.POINTS
    elif not (is_surface or morphed or "JOINTS_0" in attributes):
        # A corner that moves would have to know where its other end goes:
        # lines that change their shape stay as thin as the driver's.
        features |= Feature.LINES
    features |= {
        AlphaMode.OPAQUE: Feature(0),
        AlphaMode.MASK: Feature.ALPHA_MASK,
        AlphaMode.BLEND: Feature.ALPHA_BLEND,
    }[material.alpha_mode]
    uses = (
        TextureUse(slot, texture.uv_set, texture.transform is not None)
        for slot, texture in slots.items()
    )
    sets = sum(name.startswith("JOINTS_") for name in attributes)
    description = MaterialDescription(
        features,
        tuple(uses),
        tuple(carriers.items()),
        sets,
        tangents_of=tangents_of,
    )
    if not morphed:
        return description
    read = set(morphed) & set(description.attributes)
    in_order = tuple(
        name for name in chain(*MORPH_TEXELS.values()) if name in read
    )
    return replace(description, morphed=in_order)


def _wants_tangents(texture: Texture, morphed: Collection[str]) -> bool:
    """Whether tangents are made for the mesh of a normal map that has none.

    Not where they would have to follow: vertices that targets move, and
    coordinates that a transform turns, perhaps in time. There the shader
    makes a frame for every pixel.
    """
    return texture.transform is None and not morphed


def morph_texels(morphed: Collection[str]) -> dict[str, int]:
    """Which texel of a vertex holds what a target adds to ``morphed``.

    Only those that are needed are there and counted, by their names in
    :data:`MORPH_TEXELS`.
    """
    needed = [
        texel
        for texel, names in MORPH_TEXELS.items()
        if not set(names).isdisjoint(morphed)
    ]
    return {texel: number for number, texel in enumerate(needed)}


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
    if description.influence_sets:
        defines["MOKA_SKIN_SETS"] = description.influence_sets
    if description.morphed:
        texels = morph_texels(description.morphed)
        defines["MOKA_MORPH_TEXELS"] = len(texels)
        for texel, number in texels.items():
            defines[f"MOKA_MORPH_{texel}"] = number
    return defines


def _has_specular_factors(material: Material) -> bool:
    """Whether the factors alone give, or may give, another than 0.04."""
    return (
        material.ior != 1.5
        or material.specular_factor != 1
        or any(factor != 1 for factor in material.specular_colour_factor)
        or not material.animated.isdisjoint(SPECULAR_FACTORS)
    )


def _uv_attribute(material: Material, slot: str, texture: Texture) -> str:
    if texture.uv_set > 1:
        raise ModelError(
            f"{texture.image.where}: the {slot.replace('_', ' ')} texture of "
            f"material {material.name!r} uses TEXCOORD_{texture.uv_set}; moka "
            "draws sets 0 and 1"
        )
    return f"TEXCOORD_{texture.uv_set}"
