"""Writing a model as .glb or .gltf, through pygltflib."""

import math
import os
from collections.abc import Mapping
from dataclasses import make_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.model.binary import BinaryWriter
from moka.model.cameras import CameraDescription, Perspective
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import TOPOLOGIES, Primitive
from moka.model.model import Model
from moka.model.save_choices import has_choices, write_choices
from moka.model.save_materials import MaterialWriter
from moka.version import __version__

if TYPE_CHECKING:
    import pygltflib

    from moka.model.skins import Skin

__all__ = ["save_model"]

_MODES = {topology: mode for mode, topology in enumerate(TOPOLOGIES)}
_LIGHTS = "KHR_lights_punctual"


def save_model(model: Model, path: str | os.PathLike[str]) -> None:
    """Write ``model`` to ``path``: .glb, or .gltf with a .bin beside it.

    Geometry as float32, textures as embedded images, nodes as matrices
    unless they move, instances as nodes, skins, morph targets, animations,
    cameras, punctual lights, scenes, hidden nodes, levels of detail and
    variants. What moka does not read of a file is not written either. Raises
    ModelError if the
    suffix is another, the geometry was released, a texture is neither PNG
    nor JPEG or the file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".glb", ".gltf"):
        raise ModelError(f"{path}: a model is saved as .glb or .gltf")
    gltf = _document(model)
    try:
        for file, data in _files(gltf, path).items():
            file.write_bytes(data)
    except OSError as error:
        raise ModelError(
            f"{path}: cannot be written: {error.strerror}"
        ) from error
    except ValueError as error:  # JSON has no word for NaN or infinity
        raise ModelError(
            f"{path}: cannot be written: a number is not finite"
        ) from error


def _files(gltf: "pygltflib.GLTF2", path: Path) -> dict[Path, bytes]:
    """The files of a document, whole before the first of them is opened."""
    if path.suffix.lower() == ".glb":
        return {path: b"".join(gltf.save_to_bytes())}
    files = {}
    if gltf.buffers:
        beside = path.with_suffix(".bin")
        gltf.buffers[0].uri = quote(beside.name)
        files[beside] = gltf.binary_blob()
    return {**files, path: gltf.gltf_to_json().encode()}


def _document(model: Model) -> "pygltflib.GLTF2":
    import pygltflib

    gltf = pygltflib.GLTF2(
        asset=pygltflib.Asset(generator=f"moka {__version__}"),
        scene=model.default_scene,
        scenes=[
            pygltflib.Scene(name=name, nodes=list(roots))
            for name, roots in zip(model.scene_names, model.scenes, strict=True)
        ],
        cameras=[_camera(camera) for camera in model.cameras],
        nodes=_nodes(model),
    )
    binary = BinaryWriter(gltf)
    gltf.skins = [_skin(skin, binary) for skin in model.skins]
    materials = MaterialWriter(gltf, binary)
    for material in model.materials:
        materials.material(material)
    for mesh in model.meshes:
        primitives = [
            _primitive(primitive, binary, materials)
            for primitive in mesh.primitives
        ]
        gltf.meshes.append(
            pygltflib.Mesh(
                name=mesh.name,
                primitives=primitives,
                weights=list(mesh.weights),
            )
        )
    if model.animations:
        from moka.model.save_animations import (
            split_animated_nodes,
            write_animations,
        )

        split_animated_nodes(gltf, model)
        materials.extensions |= write_animations(gltf, model, binary)
    if has_choices(model):
        write_choices(gltf, model, materials)
    binary.finish()
    if model.lights:
        gltf.extensions[_LIGHTS] = {
            "lights": [_light(light) for light in model.lights]
        }
        materials.extensions.add(_LIGHTS)
    gltf.extensionsUsed = sorted(materials.extensions)
    gltf.extensionsRequired = sorted(materials.required)
    return gltf


def _primitive(
    primitive: Primitive, binary: BinaryWriter, materials: MaterialWriter
) -> "pygltflib.Primitive":
    import pygltflib

    if not primitive.attributes:
        raise ModelError("the geometry was released and cannot be saved")
    material, indices = primitive.material, primitive.indices
    return pygltflib.Primitive(
        attributes=_attributes(primitive.attributes, binary),
        targets=[
            _attributes(target, binary)
            for target in (
                primitive.targets.deltas if primitive.targets else ()
            )
        ],
        indices=None if indices is None else binary.indices(indices),
        mode=_MODES[primitive.topology],
        material=None if material is None else materials.material(material),
    )


def _attributes(
    arrays: Mapping[str, NDArray[np.float32]], binary: BinaryWriter
) -> "pygltflib.Attributes":
    import pygltflib

    return pygltflib.Attributes(
        **{
            name: binary.joints(array)
            if name.startswith("JOINTS")
            else binary.attribute(array, name)
            for name, array in arrays.items()
        }
    )


def _skin(skin: "Skin", binary: BinaryWriter) -> "pygltflib.Skin":
    import pygltflib

    return pygltflib.Skin(
        name=skin.name,
        joints=skin.joints.tolist(),
        inverseBindMatrices=binary.matrices(skin.inverse_bind),
    )


def _nodes(model: Model) -> list["pygltflib.Node"]:
    import pygltflib

    # pygltflib's own nodes know no weights of morph targets.
    node_type = make_dataclass(
        "Node", [("weights", list, None)], bases=(pygltflib.Node,)
    )
    tree = model.nodes
    identity = (tree.local == np.eye(4)).all(axis=(1, 2)).tolist()
    nodes = [
        node_type(
            name=name,
            matrix=None if same else local.T.reshape(-1).tolist(),
            mesh=None if mesh < 0 else mesh,
            skin=tree.skins.get(row),
            weights=tree.weights.get(row),
            camera=None if camera < 0 else camera,
            extensions={} if light < 0 else {_LIGHTS: {"light": light}},
        )
        for row, name, same, local, mesh, camera, light in zip(
            range(len(tree)),
            tree.names,
            identity,
            tree.local,
            tree.mesh.tolist(),
            tree.camera.tolist(),
            tree.light.tolist(),
            strict=True,
        )
    ]
    for row, parent in enumerate(tree.parents.tolist()):
        if parent >= 0:
            nodes[parent].children.append(row)
    return nodes


def _camera(camera: CameraDescription) -> "pygltflib.Camera":
    import pygltflib

    view = camera.projection
    if isinstance(view, Perspective):
        return pygltflib.Camera(
            name=camera.name,
            type="perspective",
            perspective=pygltflib.Perspective(
                yfov=view.yfov,
                aspectRatio=view.aspect,
                znear=view.near,
                zfar=None if math.isinf(view.far) else view.far,
            ),
        )
    return pygltflib.Camera(
        name=camera.name,
        type="orthographic",
        orthographic=pygltflib.Orthographic(
            xmag=view.xmag, ymag=view.ymag, znear=view.near, zfar=view.far
        ),
    )


def _light(light: PunctualLight) -> dict[str, Any]:
    """A plain object, since pygltflib leaves extensions to its user."""
    written: dict[str, Any] = {
        "name": light.name,
        "type": light.kind.value,
        "color": list(light.colour),
        "intensity": light.intensity,
    }
    if not math.isinf(light.range):
        written["range"] = light.range
    if light.kind is LightKind.SPOT:
        written["spot"] = {
            "innerConeAngle": light.inner_cone_angle,
            "outerConeAngle": light.outer_cone_angle,
        }
    return written
