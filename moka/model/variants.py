"""Variants of a model: other materials for some of its primitives.

Source: KHR_materials_variants.
"""

from msgspec import Struct

from moka.material.material import Material
from moka.model.schema import Index, Primitive, read_extension
from moka.model.source import GltfSource

__all__ = ["VARIANTS", "read_variant_materials", "read_variant_names"]

VARIANTS = "KHR_materials_variants"


class _Variant(Struct):
    name: str = ""


class _Variants(Struct):
    variants: list[_Variant] = []


class _Mapping(Struct):
    material: Index
    variants: list[Index]


class _Mappings(Struct):
    mappings: list[_Mapping] = []


def read_variant_names(source: GltfSource) -> tuple[str, ...]:
    """The names of the variants, in the order of the file."""
    extension = read_extension(
        source.document, VARIANTS, _Variants, source.where, ""
    )
    if extension is None:
        return ()
    return tuple(variant.name for variant in extension.variants)


def read_variant_materials(
    source: GltfSource,
    primitive: Primitive,
    path: str,
    materials: list[Material],
) -> dict[int, Material]:
    """The material of a primitive in each variant that names one for it.

    ``path`` is the primitive's. Raises ModelError for materials or variants
    that are not there, and a variant with two materials.
    """
    extension = read_extension(
        primitive, VARIANTS, _Mappings, source.where, path
    )
    if extension is None:
        return {}
    path = f"{path}.extensions.{VARIANTS}.mappings"
    count = len(read_variant_names(source))
    of_variant: dict[int, Material] = {}
    for number, mapping in enumerate(extension.mappings):
        place = f"{path}[{number}]"
        source.check_index(
            f"{place}.material", mapping.material, "materials", len(materials)
        )
        for index, variant in enumerate(mapping.variants):
            where = f"{place}.variants[{index}]"
            source.check_index(where, variant, "variants", count)
            if variant in of_variant:
                raise source.error(
                    where, f"variant {variant} has a material already"
                )
            of_variant[variant] = materials[mapping.material]
    return of_variant
