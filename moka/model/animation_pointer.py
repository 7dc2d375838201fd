"""KHR_animation_pointer: what a JSON pointer of an animation moves.

Only what moka draws has an entry here. Names on the left are those of the
glTF 2.0 asset object model, names on the right those of moka's records.
"""

import re
from collections.abc import Iterator

from msgspec import Struct

from moka.model import schema
from moka.model.animation import AnimationTarget, Kind
from moka.model.model import Model
from moka.model.source import GltfSource
from moka.model.uri import quote

__all__ = ["EXTENSION", "pointer_to", "read_pointer", "targets_of"]

EXTENSION = "KHR_animation_pointer"

_TRANSFORM = "extensions/KHR_texture_transform"
_TEXTURES = {
    "pbrMetallicRoughness/baseColorTexture": "base_colour_texture",
    "pbrMetallicRoughness/metallicRoughnessTexture": (
        "metallic_roughness_texture"
    ),
    "normalTexture": "normal_texture",
    "occlusionTexture": "occlusion_texture",
    "emissiveTexture": "emissive_texture",
}
_MATERIALS = {
    "alphaCutoff": "alpha_cutoff",
    "emissiveFactor": "emissive_factor",
    "normalTexture/scale": "normal_scale",
    "occlusionTexture/strength": "occlusion_strength",
    "pbrMetallicRoughness/baseColorFactor": "base_colour_factor",
    "pbrMetallicRoughness/metallicFactor": "metallic_factor",
    "pbrMetallicRoughness/roughnessFactor": "roughness_factor",
    "extensions/KHR_materials_emissive_strength/emissiveStrength": (
        "emissive_strength"
    ),
    "extensions/KHR_materials_ior/ior": "ior",
    "extensions/KHR_materials_specular/specularFactor": "specular_factor",
    "extensions/KHR_materials_specular/specularColorFactor": (
        "specular_colour_factor"
    ),
    **{
        f"{texture}/{_TRANSFORM}/{part}": f"{name}.{part}"
        for texture, name in _TEXTURES.items()
        for part in ("offset", "rotation", "scale")
    },
}
_NODES = {
    "translation": "translation",
    "rotation": "rotation",
    "scale": "scale",
    "weights": "weights",
    "extensions/KHR_node_visibility/visible": "visible",
}
_CAMERAS = {
    "perspective/yfov": "yfov",
    "perspective/znear": "near",
    "perspective/zfar": "far",
    "orthographic/ymag": "ymag",
    "orthographic/znear": "near",
    "orthographic/zfar": "far",
}
_LIGHTS = {
    "color": "colour",
    "intensity": "intensity",
    "range": "range",
    "spot/innerConeAngle": "inner_cone_angle",
    "spot/outerConeAngle": "outer_cone_angle",
}
_PLACES: dict[str, tuple[Kind, dict[str, str]]] = {
    "nodes": ("node", _NODES),
    "meshes": ("node", {"weights": "weights"}),
    "materials": ("material", _MATERIALS),
    "cameras": ("camera", _CAMERAS),
    "extensions/KHR_lights_punctual/lights": ("light", _LIGHTS),
}
_PLACE_OF: dict[Kind, str] = {
    "node": "nodes",
    "material": "materials",
    "camera": "cameras",
    "light": "extensions/KHR_lights_punctual/lights",
}
_POINTER = re.compile(
    rf"/({'|'.join(_PLACES)})/(\d{{1,9}})/(.+?)(?:(?<=weights)/(\d{{1,9}}))?"
)


class _Pointer(Struct):
    pointer: str


def read_pointer(source: GltfSource, path: str, target: schema.Property) -> str:
    """The pointer of a channel's ``target`` that stands at JSON ``path``.

    Raises ModelError if there is none.
    """
    found = schema.read_extension(
        target, EXTENSION, _Pointer, source.where, path
    )
    if found is None:
        raise source.error(
            f"{path}.extensions", f"{EXTENSION} is missing for a pointer"
        )
    return found.pointer


def pointer_to(target: AnimationTarget, model: Model) -> str:
    """The pointer that moves ``target`` in a file whose order is the model's.

    The reverse of :func:`targets_of`.
    """
    place = _PLACE_OF[target.kind]
    rests = [
        rest
        for rest, name in _PLACES[place][1].items()
        if name == target.property
    ]
    if target.kind == "camera":
        projection = model.cameras[target.index].projection
        kind = type(projection).__name__.lower()
        rests = [rest for rest in rests if rest.startswith(kind)]
    element = "" if target.element is None else f"/{target.element}"
    return f"/{place}/{target.index}/{rests[0]}{element}"


def targets_of(
    source: GltfSource, path: str, pointer: str, light_count: int
) -> list[AnimationTarget]:
    """What ``pointer``, which stands at JSON ``path``, moves.

    Nodes by their index in the file. Empty for what moka does not draw; the
    weights of a mesh are those of all nodes that show it and have none of
    their own. Raises ModelError for a pointer to nothing.
    """
    if not pointer.startswith("/"):
        raise source.error(path, f"{quote(pointer)} does not begin with '/'")
    match = _POINTER.fullmatch(pointer)
    if match is None:
        return []
    place, number, rest, element = match.groups()
    kind, names = _PLACES[place]
    name = names.get(rest)
    if name is None:
        return []
    index = int(number)
    document = source.document
    count = light_count if kind == "light" else len(getattr(document, place))
    source.check_index(path, index, place.rpartition("/")[2], count)
    if not _exists(document, kind, index, rest):
        raise source.error(path, f"{quote(pointer)} names nothing in the file")
    chosen = None if element is None else int(element)
    if place == "meshes":
        return [
            AnimationTarget("node", node, name, chosen)
            for node in _showing(document, index)
        ]
    return [AnimationTarget(kind, index, name, chosen)]


def _exists(
    document: schema.Document, kind: Kind, index: int, rest: str
) -> bool:
    """Whether the objects are there that hold what a pointer names."""
    owner, _, _ = rest.partition("/extensions/KHR_texture_transform/")
    if kind == "camera":
        holder = rest.partition("/")[0]
        return getattr(document.cameras[index], holder) is not None
    if kind != "material":
        return True
    place = _TEXTURES.get(owner)
    if place is None:
        place = _TEXTURES.get(rest.rpartition("/")[0])
        return place is None or _texture(document, index, place) is not None
    texture = _texture(document, index, place)
    return texture is not None and "KHR_texture_transform" in (
        texture.extensions or {}
    )


def _texture(
    document: schema.Document, index: int, name: str
) -> schema.TextureInfo | None:
    material = document.materials[index]
    pbr = material.pbr_metallic_roughness or schema.PbrMetallicRoughness()
    return {
        "base_colour_texture": pbr.base_color_texture,
        "metallic_roughness_texture": pbr.metallic_roughness_texture,
        "normal_texture": material.normal_texture,
        "occlusion_texture": material.occlusion_texture,
        "emissive_texture": material.emissive_texture,
    }[name]


def _showing(document: schema.Document, mesh: int) -> Iterator[int]:
    """Nodes that show a mesh with its own weights."""
    for index, node in enumerate(document.nodes):
        if node.mesh == mesh and not node.weights:
            yield index
