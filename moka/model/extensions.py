"""The one table of glTF extensions that moka draws as they are meant."""

from moka.model.source import GltfSource
from moka.model.uri import quote

__all__ = ["SUPPORTED_EXTENSIONS", "check_required", "unsupported_extensions"]

SUPPORTED_EXTENSIONS: dict[str, str] = {
    "EXT_mesh_gpu_instancing": "a mesh at many places of one node",
    "EXT_meshopt_compression": "vertices and indices of meshoptimizer",
    "EXT_texture_avif": "AVIF images",
    "EXT_texture_webp": "WebP images",
    "KHR_animation_pointer": "animated materials, lights and cameras",
    "KHR_draco_mesh_compression": "triangles compressed by Draco",
    "KHR_lights_punctual": "directional, point and spot lights",
    "KHR_materials_emissive_strength": "emission beyond 1",
    "KHR_materials_ior": "dielectrics of any index of refraction",
    "KHR_materials_specular": "how much dielectrics reflect, and its colour",
    "KHR_materials_unlit": "materials of constant radiance",
    "KHR_materials_variants": "other materials by the name of a variant",
    "KHR_mesh_quantization": "vertex attributes of 8 and 16 bits",
    "KHR_meshopt_compression": "the same, with a filter for colours",
    "KHR_node_visibility": "nodes hidden with all below them",
    "KHR_texture_basisu": "KTX2 images, ETC1S and UASTC",
    "KHR_texture_transform": "offset, rotation and scale of textures",
    "MSFT_lod": "levels of detail of nodes and materials",
}


def check_required(source: GltfSource) -> None:
    """Raise ModelError if the file cannot be drawn without what is missing."""
    required = source.document.extensions_required
    for index, name in enumerate(required):
        if name not in SUPPORTED_EXTENSIONS:
            raise source.error(
                f"extensionsRequired[{index}]",
                f"the extension {quote(name)} is required and not supported; "
                "export the model without it",
            )


def unsupported_extensions(source: GltfSource) -> tuple[str, ...]:
    """Names of optional extensions that are used and left out, sorted."""
    used = set(source.document.extensions_used)
    return tuple(sorted(used - SUPPORTED_EXTENSIONS.keys()))
