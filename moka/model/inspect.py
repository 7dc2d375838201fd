"""What a model holds, for ``moka info``: read without decoding a texture."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moka.commands.descriptors import Topology
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.image_header import pixel_size
from moka.material.material import Material
from moka.model.cameras import CameraDescription, Perspective
from moka.model.lights import PunctualLight
from moka.model.model import Model

if TYPE_CHECKING:
    from moka.model.animation import Animation

__all__ = ["describe", "format_description"]

_TEXTURES = {
    "base colour": "base_colour_texture",
    "metallic roughness": "metallic_roughness_texture",
    "normal": "normal_texture",
    "occlusion": "occlusion_texture",
    "emissive": "emissive_texture",
    "specular": "specular_texture",
    "specular colour": "specular_colour_texture",
}

_LINES = (Topology.LINES, Topology.LINE_LOOP, Topology.LINE_STRIP)
_KINDS = {
    "triangles": tuple(set(Topology) - {Topology.POINTS, *_LINES}),
    "lines": _LINES,
    "points": (Topology.POINTS,),
}


def describe(model: Model) -> dict[str, Any]:
    """Structure, sizes, extensions and memory of ``model``.

    The result holds only what JSON knows. ``scene`` is about the default
    scene with every instance counted, ``memory`` in bytes: vertex data and
    encoded images as they are held or stored, textures as RGBA8 with all
    mip levels. Sizes of images that are missing or broken are null.
    """
    primitives = [each for mesh in model.meshes for each in mesh.primitives]
    textures = _textures(model.materials)
    return {
        "name": model.name,
        "path": None if model.path is None else str(model.path),
        "scenes": [
            {"name": name, "roots": len(roots)}
            for name, roots in zip(model.scene_names, model.scenes, strict=True)
        ],
        "default_scene": model.default_scene,
        "variants": list(model.variants),
        "nodes": int(np.count_nonzero(model.nodes.source >= 0)),
        "instances": int(np.count_nonzero(model.nodes.source < 0)),
        "hidden_nodes": len(model.nodes.hidden),
        "levels_of_detail": {
            "nodes": 0
            if model.nodes.levels is None
            else len(model.nodes.levels.node),
            "materials": sum(
                1 + len(material.coarser)
                for material in model.materials
                if material.coarser
            ),
        },
        "meshes": len(model.meshes),
        "primitives": len(primitives),
        "scene": _scene(model),
        "skins": [
            {"name": skin.name, "joints": len(skin.joints)}
            for skin in model.skins
        ],
        "morph_targets": sum(mesh.target_count for mesh in model.meshes),
        "materials": [_material(material) for material in model.materials],
        "textures": textures,
        "cameras": [_camera(camera) for camera in model.cameras],
        "lights": [_light(light) for light in model.lights],
        "animations": [_animation(each) for each in model.animations],
        "extensions": list(model.extensions),
        "required_extensions": list(model.required_extensions),
        "unsupported_extensions": list(model.unsupported_extensions),
        "omitted": dict(model.omitted),
        "memory": {
            "geometry": _geometry_bytes(model),
            "encoded_images": sum(each["bytes"] or 0 for each in textures),
            "textures": sum(each["texture_bytes"] or 0 for each in textures),
        },
    }


def format_description(description: dict[str, Any]) -> str:
    """The result of :func:`describe` as text for a person, without colour."""
    scene, memory = description["scene"], description["memory"]
    lines = [
        description["path"] or description["name"] or "model in memory",
        f"  scenes      {len(description['scenes'])}, default "
        f"{description['default_scene']}",
        f"  nodes       {_nodes_text(description)}",
        f"  meshes      {description['meshes']} of "
        f"{description['primitives']} primitives",
        "  drawn       "
        + ", ".join(
            f"{scene[kind]} {kind}"
            for kind in ("instances", *_KINDS)
            if scene[kind] or kind == "instances"
        ),
    ]
    if scene["bounds"] is not None:
        least, greatest = (
            ", ".join(f"{value:.4g}" for value in corner)
            for corner in scene["bounds"]
        )
        lines.append(f"  bounds      ({least}) to ({greatest}) m")
    if description["variants"]:
        lines.append(f"  variants    {', '.join(description['variants'])}")
    skins, targets = description["skins"], description["morph_targets"]
    if skins:
        joints = sum(skin["joints"] for skin in skins)
        lines.append(f"  skins       {len(skins)} of {joints} joints")
    if targets:
        lines.append(f"  morphs      {targets} targets")
    for title, key, line in (
        ("materials", "materials", _material_line),
        ("textures", "textures", _texture_line),
        ("cameras", "cameras", _camera_line),
        ("lights", "lights", _light_line),
        ("animations", "animations", _animation_line),
    ):
        lines.append(f"  {title:<11} {len(description[key])}")
        lines += [f"    {line(each)}" for each in description[key]]
    lines += [
        f"  memory      geometry {_size(memory['geometry'])}, encoded images "
        f"{_size(memory['encoded_images'])}, as textures "
        f"{_size(memory['textures'])}",
        f"  extensions  {', '.join(description['extensions']) or 'none'}",
    ]
    if description["required_extensions"]:
        required = ", ".join(description["required_extensions"])
        lines.append(f"  required    {required}")
    unsupported = description["unsupported_extensions"]
    if unsupported:
        lines.append(f"  unsupported {', '.join(unsupported)}")
    omitted = description["omitted"]
    if omitted:
        counts = (f"{count} {name}" for name, count in omitted.items())
        lines.append(f"  not drawn   {', '.join(counts)}")
    return "\n".join(lines)


def _nodes_text(description: dict[str, Any]) -> str:
    levels = description["levels_of_detail"]
    more = (
        (description["instances"], "instances of their meshes"),
        (description["hidden_nodes"], "hidden"),
        (levels["nodes"], "levels of detail"),
        (levels["materials"], "levels of materials"),
    )
    words = [f"{count} {what}" for count, what in more if count]
    return ", ".join([str(description["nodes"]), *words])


def _scene(model: Model) -> dict[str, Any]:
    _, meshes = model.instances()
    shown = [
        primitive
        for mesh in meshes.tolist()
        for primitive in model.meshes[mesh].primitives
    ]
    bounds = model.bounds()
    return {
        "instances": len(meshes),
        "vertices": sum(each.vertex_count for each in shown),
        **{
            kind: sum(
                each.element_count
                for each in shown
                if each.topology in topologies
            )
            for kind, topologies in _KINDS.items()
        },
        "bounds": None if bounds is None else bounds.tolist(),
    }


def _geometry_bytes(model: Model) -> int:
    """Arrays that primitives share are counted once."""
    arrays = {}
    for mesh in model.meshes:
        for primitive in mesh.primitives:
            for array in primitive.attributes.values():
                arrays[id(array)] = array.nbytes
            if primitive.indices is not None:
                arrays[id(primitive.indices)] = primitive.indices.nbytes
            for target in primitive.targets.deltas if primitive.targets else ():
                for array in target.values():
                    arrays[id(array)] = array.nbytes
    return sum(arrays.values())


def _material(material: Material) -> dict[str, Any]:
    return {
        "name": material.name,
        "alpha_mode": material.alpha_mode.value,
        "double_sided": material.double_sided,
        "unlit": material.unlit,
        "ior": material.ior,
        "specular": material.specular_factor,
        "specular_colour": list(material.specular_colour_factor),
        "textures": [
            use
            for use, name in _TEXTURES.items()
            if getattr(material, name) is not None
        ],
    }


def _textures(materials: list[Material]) -> list[dict[str, Any]]:
    """The images that materials use, each with what they use it as."""
    images: dict[int, EncodedImage] = {}
    uses: dict[int, dict[str, None]] = {}
    for material in materials:
        for use, name in _TEXTURES.items():
            texture = getattr(material, name)
            if texture is not None:
                images[id(texture.image)] = texture.image
                uses.setdefault(id(texture.image), {})[use] = None
    return [
        {
            "image": image.where,
            "file": None if image.path is None else str(image.path),
            "uses": list(uses[key]),
            **_image(image),
        }
        for key, image in images.items()
    ]


def _image(image: EncodedImage) -> dict[str, Any]:
    size, count, texture = None, None, None
    try:
        size = pixel_size(image)
        count = _encoded_bytes(image)
    except (ImageFileError, OSError):
        pass  # its error belongs to who needs the texels; here it is "null"
    if size is not None:
        texture = _texture_bytes(*size)
    width, height = size or (None, None)
    return {
        "width": width,
        "height": height,
        "bytes": count,
        "texture_bytes": texture,
    }


def _encoded_bytes(image: EncodedImage) -> int:
    if image.path is not None:
        return Path(image.path).stat().st_size
    return len(image.read())


def _texture_bytes(width: int, height: int) -> int:
    """RGBA8 with its whole chain of mip levels."""
    levels = max(width, height).bit_length()
    return sum(
        4 * max(1, width >> level) * max(1, height >> level)
        for level in range(levels)
    )


def _camera(camera: CameraDescription) -> dict[str, Any]:
    view = camera.projection
    common = {
        "name": camera.name,
        "near": view.near,
        "far": None if math.isinf(view.far) else view.far,
    }
    if isinstance(view, Perspective):
        kind = {"type": "perspective", "yfov": view.yfov, "aspect": view.aspect}
    else:
        kind = {"type": "orthographic", "xmag": view.xmag, "ymag": view.ymag}
    return {**common, **kind}


def _light(light: PunctualLight) -> dict[str, Any]:
    return {
        "name": light.name,
        "type": light.kind.value,
        "colour": list(light.colour),
        "intensity": light.intensity,
        "range": None if math.isinf(light.range) else light.range,
    }


def _animation(animation: "Animation") -> dict[str, Any]:
    times = {id(channel.times) for channel in animation.channels}
    return {
        "name": animation.name,
        "duration": animation.duration,
        "channels": len(animation.channels),
        "sets_of_times": len(times),
        "properties": sorted(
            {
                f"{channel.target.kind} {channel.target.property}"
                for channel in animation.channels
            }
        ),
    }


def _material_line(material: dict[str, Any]) -> str:
    words = [material["alpha_mode"].lower()]
    words += ["double-sided"] if material["double_sided"] else []
    words += ["unlit"] if material["unlit"] else []
    if material["ior"] != 1.5:
        words.append(f"IOR {material['ior']:g}")
    colour = material["specular_colour"]
    if material["specular"] != 1:
        words.append(f"specular {material['specular']:g}")
    if any(factor != 1 for factor in colour):
        words.append(
            f"specular colour {' '.join(f'{factor:g}' for factor in colour)}"
        )
    return f"{_name(material)}: {', '.join(words + material['textures'])}"


def _texture_line(texture: dict[str, Any]) -> str:
    size = "size unknown"
    if texture["width"] is not None:
        size = f"{texture['width']}x{texture['height']}"
    count = "missing"
    if texture["bytes"] is not None:
        count = _size(texture["bytes"])
    name = texture["image"].rpartition(": ")[2]
    if texture["file"] is not None:
        name = Path(texture["file"]).name
    if texture["texture_bytes"] is not None:
        count += f" ({_size(texture['texture_bytes'])} on the GPU)"
    return f"{name}: {size}, {count}, {', '.join(texture['uses'])}"


def _camera_line(camera: dict[str, Any]) -> str:
    return f"{_name(camera)}: {camera['type']}"


def _light_line(light: dict[str, Any]) -> str:
    unit = "lx" if light["type"] == "directional" else "cd"
    return f"{_name(light)}: {light['type']}, {light['intensity']:g} {unit}"


def _animation_line(animation: dict[str, Any]) -> str:
    return (
        f"{_name(animation)}: {animation['duration']:.4g} s, "
        f"{animation['channels']} channels; "
        + ", ".join(animation["properties"])
    )


def _name(thing: dict[str, Any]) -> str:
    return thing["name"] or "(no name)"


def _size(count: int) -> str:
    if count < 1000:
        return f"{count} B"
    return f"{count / 1e3:.0f} kB" if count < 1e6 else f"{count / 1e6:.1f} MB"
