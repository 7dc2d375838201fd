"""Loading a glTF model: the parts are read by the modules next to this."""

from typing import TYPE_CHECKING

import numpy as np

from moka.core.log import get_logger
from moka.model.cameras import read_cameras
from moka.model.extensions import check_required, unsupported_extensions
from moka.model.lights import read_lights
from moka.model.model import Model
from moka.model.nodes import NodeTree, read_nodes
from moka.model.read_materials import read_materials
from moka.model.read_meshes import read_meshes
from moka.model.source import GltfSource, ModelSource, open_source
from moka.model.uri import quote

if TYPE_CHECKING:
    from moka.model.animation import Animation

__all__ = ["load_model"]

_LOGGER = get_logger(__name__)

_VARIANTS = "KHR_materials_variants"


def load_model(source: ModelSource, *, scene: int | str | None = None) -> Model:
    """Read a glTF 2.0 model: .gltf, .glb, their bytes or a pygltflib.GLTF2.

    ``scene``, a name or an index, becomes the model's default scene in place
    of the one that the file names.

    Vertex data is not copied where the file has it as floats, images are
    neither decoded nor, if they are files, opened. Raises ModelError, naming
    the file and the JSON path, for a file that is missing, broken or needs
    an extension that moka does not support.
    """
    opened = open_source(source)
    check_required(opened)
    document = opened.document
    materials = read_materials(opened)
    lights = read_lights(opened)
    nodes = read_nodes(opened, len(lights))
    animations: list[Animation] = []
    rest_pose, still = None, 0
    if document.animations:
        from moka.model.animated_materials import marked_materials
        from moka.model.read_animations import read_animations

        animations, rest_pose, still = read_animations(
            opened, nodes, len(lights)
        )
        materials = marked_materials(materials, animations)
    meshes = read_meshes(opened, materials)
    path = opened.path
    model = Model(
        name=path.stem if path else "",
        path=path,
        nodes=nodes,
        meshes=meshes,
        materials=materials,
        cameras=read_cameras(opened),
        lights=lights,
        scenes=_read_scenes(opened, nodes),
        scene_names=[scene.name for scene in document.scenes] or [""],
        extensions=tuple(sorted(set(document.extensions_used))),
        unsupported_extensions=unsupported_extensions(opened),
        required_extensions=tuple(sorted(set(document.extensions_required))),
        omitted=_omitted(opened, still),
        animations=animations,
        rest_pose=rest_pose,
    )
    if document.skins:
        from moka.model.skins import check_skinned, read_skins

        model.skins = read_skins(opened, nodes)
        check_skinned(opened, nodes, meshes, model.skins)
    if _VARIANTS in (document.extensions or ()):
        from moka.model.variants import read_variant_names

        model.variants = read_variant_names(opened)
    if document.scene is not None:
        opened.check_index(
            "scene", document.scene, "scenes", len(document.scenes)
        )
        model.default_scene = document.scene
    model.default_scene = model.scene_index(scene)
    _log(opened, model)
    return model


def _log(source: GltfSource, model: Model) -> None:
    document = source.document
    _LOGGER.info(
        "%s: read, %d nodes, %d meshes, %d materials, %d images",
        source.where,
        len(document.nodes),
        len(document.meshes),
        len(document.materials),
        len(document.images),
    )
    if model.unsupported_extensions:
        _LOGGER.warning(
            "%s: is drawn without %s, see moka info",
            source.where,
            ", ".join(map(quote, model.unsupported_extensions)),
        )
    for name, count in model.omitted.items():
        _LOGGER.warning("%s: %d %s are left out", source.where, count, name)


def _read_scenes(source: GltfSource, nodes: NodeTree) -> list[list[int]]:
    """The rows of each scene's roots; all roots if there are no scenes."""
    rows = nodes.rows_of_file()
    if not source.document.scenes:
        return [np.flatnonzero(nodes.parents < 0).tolist()]
    scenes = []
    for index, scene in enumerate(source.document.scenes):
        listed = np.array(scene.nodes, np.int64)
        for number in np.flatnonzero(listed >= len(rows)).tolist():
            source.check_index(
                f"scenes[{index}].nodes[{number}]",
                scene.nodes[number],
                "nodes",
                len(rows),
            )
        roots = rows[listed]
        for number in np.flatnonzero(nodes.parents[roots] >= 0).tolist():
            raise source.error(
                f"scenes[{index}].nodes[{number}]",
                f"nodes[{scene.nodes[number]}] has a parent",
            )
        scenes.append(nodes.with_levels(roots).tolist())
    return scenes


def _omitted(source: GltfSource, still_channels: int) -> dict[str, int]:
    """What the document holds and moka does not draw, with its number."""
    document = source.document
    primitives = [
        primitive for mesh in document.meshes for primitive in mesh.primitives
    ]
    counts = {
        "animation channels": still_channels,
        "primitives without positions": sum(
            "POSITION" not in each.attributes for each in primitives
        ),
    }
    return {name: count for name, count in counts.items() if count}
