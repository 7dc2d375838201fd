"""Writing what chooses: hidden nodes, levels of detail, variants."""

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from moka.model.model import Model
from moka.model.save_materials import MaterialWriter

if TYPE_CHECKING:
    import pygltflib

__all__ = ["has_choices", "write_choices"]

_VISIBILITY = "KHR_node_visibility"
_LEVELS, _COVERAGE = "MSFT_lod", "MSFT_screencoverage"
_VARIANTS = "KHR_materials_variants"


def has_choices(model: Model) -> bool:
    """Whether there is anything for :func:`write_choices` to write."""
    return bool(
        len(model.nodes.hidden)
        or model.nodes.levels is not None
        or model.variants
        or any(material.coarser for material in model.materials)
    )


def write_choices(
    gltf: "pygltflib.GLTF2", model: Model, materials: MaterialWriter
) -> None:
    """Add to a document whose nodes, meshes and materials are written."""
    for row in model.nodes.hidden.tolist():
        gltf.nodes[row].extensions[_VISIBILITY] = {"visible": False}
        materials.extensions.add(_VISIBILITY)
    _write_node_levels(gltf, model, materials)
    for material in model.materials:
        if material.coarser:
            ids = [materials.material(each) for each in material.coarser]
            finest = gltf.materials[materials.material(material)]
            finest.extensions[_LEVELS] = {"ids": ids}
            finest.extras = {_COVERAGE: list(material.limits)}
            materials.extensions.add(_LEVELS)
    if model.variants:
        _write_variants(gltf, model, materials)


def _write_node_levels(
    gltf: "pygltflib.GLTF2", model: Model, materials: MaterialWriter
) -> None:
    """Coarser levels are of no scene and no parent's, but their finest's."""
    levels = model.nodes.levels
    if levels is None:
        return
    materials.extensions.add(_LEVELS)
    coarser = set(levels.node[levels.level > 0].tolist())
    for owner, name in [
        *((node, "children") for node in gltf.nodes),
        *((scene, "nodes") for scene in gltf.scenes),
    ]:
        kept = [each for each in getattr(owner, name) if each not in coarser]
        setattr(owner, name, kept)
    groups: dict[int, list[int]] = defaultdict(list)
    limits: dict[int, list[float]] = defaultdict(list)
    for node, group, limit in zip(
        levels.node.tolist(),
        levels.group.tolist(),
        levels.limit.tolist(),
        strict=True,
    ):
        groups[group].append(node)
        limits[group].append(limit)
    for group, (finest, *ids) in groups.items():
        gltf.nodes[finest].extensions[_LEVELS] = {"ids": ids}
        gltf.nodes[finest].extras = {_COVERAGE: limits[group]}


def _write_variants(
    gltf: "pygltflib.GLTF2", model: Model, materials: MaterialWriter
) -> None:
    materials.extensions.add(_VARIANTS)
    gltf.extensions[_VARIANTS] = {
        "variants": [{"name": name} for name in model.variants]
    }
    for mesh, written in zip(model.meshes, gltf.meshes, strict=True):
        for primitive, target in zip(
            mesh.primitives, written.primitives, strict=True
        ):
            numbers: dict[int, list[int]] = defaultdict(list)
            for variant, material in primitive.variants.items():
                numbers[materials.material(material)].append(variant)
            mappings: list[dict[str, Any]] = [
                {"material": material, "variants": variants}
                for material, variants in numbers.items()
            ]
            if mappings:
                target.extensions[_VARIANTS] = {"mappings": mappings}
