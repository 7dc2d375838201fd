"""From the materials of a glTF document to moka's.

Sources: glTF 2.0 specification, section 3.9 (materials),
KHR_texture_transform, KHR_materials_unlit, KHR_materials_emissive_strength,
KHR_materials_ior, KHR_materials_specular.
"""

from typing import Annotated, Any

import msgspec
from msgspec.structs import replace

from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)
from moka.model import schema
from moka.model.images import ImageReader, sampler_descriptor
from moka.model.schema import Vector2, Vector3, read_extension
from moka.model.source import GltfSource

__all__ = ["emission_of", "read_materials"]

# What vertices carry: TEXCOORD_0 and TEXCOORD_1.
_UV_SETS = 2
_LEVELS = "MSFT_lod"


class _TextureTransform(msgspec.Struct, rename="camel"):
    offset: Vector2 = (0.0, 0.0)
    rotation: float = 0.0
    scale: Vector2 = (1.0, 1.0)
    tex_coord: int | None = None


class _EmissiveStrength(msgspec.Struct, rename="camel"):
    emissive_strength: Annotated[float, msgspec.Meta(ge=0)] = 1.0


class _Ior(msgspec.Struct):
    ior: float = 1.5


_Positive = Annotated[float, msgspec.Meta(ge=0)]


class _Specular(msgspec.Struct, rename="camel"):
    specular_factor: _Positive = 1.0
    specular_texture: schema.TextureInfo | None = None
    specular_color_factor: tuple[_Positive, _Positive, _Positive] = (1, 1, 1)
    specular_color_texture: schema.TextureInfo | None = None


def read_materials(source: GltfSource) -> list[Material]:
    """All materials, in the order of the file.

    Base colour, metalness and others are clamped to 0..1, where the
    specification keeps them, because a lobe outside of it would make energy.
    Raises ModelError naming the JSON path of what is wrong.
    """
    images = ImageReader(source)
    materials = [
        _read_material(source, images, f"materials[{index}]", material)
        for index, material in enumerate(source.document.materials)
    ]
    if any(
        _LEVELS in (material.extensions or ())
        for material in source.document.materials
    ):
        _add_levels(source, materials)
    return materials


def _add_levels(source: GltfSource, materials: list[Material]) -> None:
    """Give finest levels of detail the coarser ones, which have none."""
    from moka.model.lods import read_levels

    plain = materials.copy()
    for index, material in enumerate(source.document.materials):
        coarser, limits = read_levels(
            source, material, f"materials[{index}]", "materials", len(plain)
        )
        if coarser:
            materials[index] = replace(
                plain[index],
                coarser=tuple(plain[level] for level in coarser),
                limits=tuple(limits),
            )


def emission_of(source: GltfSource, index: int) -> tuple[Vector3, float]:
    """Emissive factor and strength of a material, which are one in ours."""
    material = source.document.materials[index]
    return _emission(source, f"materials[{index}]", material)


def _emission(
    source: GltfSource, path: str, material: schema.Material
) -> tuple[Vector3, float]:
    red, green, blue = (max(0.0, each) for each in material.emissive_factor)
    name = "KHR_materials_emissive_strength"
    emission = read_extension(
        material, name, _EmissiveStrength, source.where, path
    )
    strength = 1.0 if emission is None else emission.emissive_strength
    return (red, green, blue), strength


def _read_material(
    source: GltfSource,
    images: ImageReader,
    path: str,
    material: schema.Material,
) -> Material:
    def texture(owner: str, info: schema.TextureInfo | None) -> Texture | None:
        if info is None:
            return None
        return _read_texture(source, images, f"{path}.{owner}", info)

    def extension(name: str, type_: Any) -> Any:
        return read_extension(material, name, type_, source.where, path)

    pbr = material.pbr_metallic_roughness or schema.PbrMetallicRoughness()
    normal = material.normal_texture
    occlusion = material.occlusion_texture
    (red, green, blue), strength = _emission(source, path, material)
    refraction = extension("KHR_materials_ior", _Ior) or _Ior()
    # 0 is the extension's word for a reflectance of 1 at all angles.
    if refraction.ior < 1 and refraction.ior != 0:
        raise source.error(
            f"{path}.extensions.KHR_materials_ior.ior",
            f"is {refraction.ior:g}; it is 0, or 1 and more",
        )
    specular = extension("KHR_materials_specular", _Specular) or _Specular()
    return Material(
        name=material.name,
        base_colour_factor=_clamped_colour(pbr.base_color_factor),
        metallic_factor=_clamp(pbr.metallic_factor),
        roughness_factor=_clamp(pbr.roughness_factor),
        normal_scale=1.0 if normal is None else normal.scale,
        occlusion_strength=(
            1.0 if occlusion is None else _clamp(occlusion.strength)
        ),
        emissive_factor=(
            red * strength,
            green * strength,
            blue * strength,
        ),
        base_colour_texture=texture(
            "pbrMetallicRoughness.baseColorTexture", pbr.base_color_texture
        ),
        metallic_roughness_texture=texture(
            "pbrMetallicRoughness.metallicRoughnessTexture",
            pbr.metallic_roughness_texture,
        ),
        normal_texture=texture("normalTexture", normal),
        occlusion_texture=texture("occlusionTexture", occlusion),
        emissive_texture=texture("emissiveTexture", material.emissive_texture),
        ior=refraction.ior,
        specular_factor=_clamp(specular.specular_factor),
        specular_colour_factor=specular.specular_color_factor,
        specular_texture=texture(
            "extensions.KHR_materials_specular.specularTexture",
            specular.specular_texture,
        ),
        specular_colour_texture=texture(
            "extensions.KHR_materials_specular.specularColorTexture",
            specular.specular_color_texture,
        ),
        alpha_mode=AlphaMode(material.alpha_mode),
        alpha_cutoff=material.alpha_cutoff,
        double_sided=material.double_sided,
        unlit=extension("KHR_materials_unlit", dict) is not None,
    )


def _read_texture(
    source: GltfSource,
    images: ImageReader,
    path: str,
    info: schema.TextureInfo,
) -> Texture | None:
    """None if only an extension that moka does not read has the image."""
    document = source.document
    source.check_index(
        f"{path}.index", info.index, "textures", len(document.textures)
    )
    texture = document.textures[info.index]
    place = f"textures[{info.index}]"
    image = images.of_texture(info.index)
    if image is None:
        return None
    sampler = schema.Sampler()
    if texture.sampler is not None:
        source.check_index(
            f"{place}.sampler",
            texture.sampler,
            "samplers",
            len(document.samplers),
        )
        sampler = document.samplers[texture.sampler]
    uv_set = info.tex_coord
    transform = None
    extension = read_extension(
        info, "KHR_texture_transform", _TextureTransform, source.where, path
    )
    if extension is not None:
        if extension.tex_coord is not None:
            uv_set = extension.tex_coord
        transform = TextureTransform(
            extension.offset, extension.rotation, extension.scale
        )
    if not 0 <= uv_set < _UV_SETS:
        raise source.error(
            path,
            f"uses TEXCOORD_{uv_set}; moka reads TEXCOORD_0 and TEXCOORD_1",
        )
    return Texture(
        image,
        sampler_descriptor(sampler),
        uv_set,
        transform,
    )


def _clamp(value: float) -> float:
    return min(max(value, 0.0), 1.0)


def _clamped_colour(colour: schema.Vector4) -> schema.Vector4:
    red, green, blue, alpha = colour
    return _clamp(red), _clamp(green), _clamp(blue), _clamp(alpha)
