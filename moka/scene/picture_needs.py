"""What one picture needs of a file, and what it leaves where it is.

The same choices as ``moka render`` makes, without a GPU: which nodes are in
the scene, seen and of the level to be seen, and which materials and images
their primitives sample.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.material.description import Feature, describe_material
from moka.material.sampled_textures import texture_slots
from moka.model.mesh import Primitive
from moka.model.model import Model
from moka.scene.camera_choice import choose_camera, parse_camera
from moka.scene.culling import boxes_in_frustum
from moka.scene.scene import Scene

__all__ = ["format_needs", "picture_needs"]

# How many of what is not needed a person is told by name.
_NAMED = 8


def picture_needs(
    model: Model,
    *,
    scene: str | int | None = None,
    variant: str | int | None = None,
    camera: str | None = None,
    size: tuple[int, int] = (1280, 720),
) -> dict[str, Any]:
    """What a picture with these options needs of ``model``.

    The options are those of ``moka render``. The result holds only what JSON
    knows: how many draws there are and why others are not made; the meshes,
    materials and images that are not needed; how many nodes are in another
    scene. Of an animated model as its nodes are at rest.
    Raises ModelError or OptionError for a choice that is not there.
    """
    world = Scene()
    placed = world.add(model, scene=scene, variant=variant)
    world.update()
    aspect = size[0] / size[1]
    choice = None if camera is None else parse_camera(camera)
    eye = choose_camera(world, choice, aspect)
    drawables = world.drawables
    inside = boxes_in_frustum(eye.frustum_planes(aspect), drawables.boxes)
    level = np.ones(len(drawables), np.bool_)
    if drawables.levels is not None:
        level = drawables.levels.shown(drawables.world_bounds, eye, aspect)
    shown = world.shown
    needed = shown & level & inside
    primitives = [
        drawables.primitives[index]
        for index in np.unique(drawables.primitive[needed]).tolist()
    ]
    materials = {id(each.material) for each in primitives}
    images = _sampled(primitives)
    in_scene = np.isin(
        model.nodes.roots(), model.scenes[model.scene_index(scene)]
    )
    return {
        "size": list(size),
        "scene": model.scene_index(scene),
        "variant": model.variant_index(variant),
        "draws": {
            "made": int(needed.sum()),
            "hidden": int((~shown).sum()),
            "other_levels": int((shown & ~level).sum()),
            "outside_view": int((shown & level & ~inside).sum()),
        },
        "nodes_outside_scene": int(
            ((model.nodes.source >= 0) & ~in_scene).sum()
        ),
        "unused_meshes": _unused_meshes(model, placed.layout.node[needed]),
        "unused_materials": [
            {"index": number, "name": material.name}
            for number, material in enumerate(model.materials)
            if id(material) not in materials
        ],
        "unused_images": _unused_images(model, images),
    }


def format_needs(needs: dict[str, Any]) -> str:
    """The result of :func:`picture_needs` as text for a person."""
    draws = needs["draws"]
    left = [
        f"{draws[key]} {words}"
        for key, words in (
            ("hidden", "hidden"),
            ("other_levels", "of other levels of detail"),
            ("outside_view", "outside the view"),
        )
        if draws[key]
    ]
    total = sum(draws.values())
    lines = [
        f"  a picture   of {'x'.join(map(str, needs['size']))} makes "
        f"{draws['made']} of {total} draws"
        + (f"; {', '.join(left)}" if left else "")
    ]
    if needs["nodes_outside_scene"]:
        lines.append(
            f"    not in its scene: {needs['nodes_outside_scene']} nodes"
        )
    for what in ("meshes", "materials", "images"):
        unused = needs[f"unused_{what}"]
        if unused:
            lines.append(
                f"    not needed: {len(unused)} {what}: {_few(unused)}"
            )
    return "\n".join(lines)


def _few(unused: list[Any]) -> str:
    """Names of the first ones, or their positions if they have none."""
    names = [
        each if isinstance(each, str) else each["name"] or str(each["index"])
        for each in unused[:_NAMED]
    ]
    more = len(unused) - len(names)
    return ", ".join(names) + (f" and {more} more" if more else "")


def _sampled(primitives: list[Primitive]) -> set[int]:
    """The images, by identity, that a picture of primitives samples."""
    images = set()
    for primitive in primitives:
        material = primitive.material
        if material is None:
            continue
        description = describe_material(
            material,
            primitive.attributes,
            primitive.topology,
            morphed=primitive.morphed,
            carries=False,
        )
        names = {use.slot for use in description.textures}
        if Feature.PACKED_OCCLUSION in description.features:
            names.add("occlusion")
        slots = texture_slots(material)
        images |= {id(slots[name].image) for name in names}
    return images


def _unused_meshes(
    model: Model, nodes: NDArray[np.intp]
) -> list[dict[str, Any]]:
    used = set(model.nodes.mesh[nodes].tolist())
    return [
        {"index": number, "name": mesh.name}
        for number, mesh in enumerate(model.meshes)
        if number not in used
    ]


def _unused_images(model: Model, used: set[int]) -> list[str]:
    """Where the images of materials come from that are not sampled."""
    where: dict[int, str] = {}
    for material in model.materials:
        for texture in material.textures:
            image = texture.image
            where[id(image)] = (
                image.where.rpartition(": ")[2]
                if image.path is None
                else str(image.path)
            )
    return [name for key, name in where.items() if key not in used]
