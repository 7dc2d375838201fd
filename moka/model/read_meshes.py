"""From the meshes of a glTF document to arrays of vertices.

Source: glTF 2.0 specification, section 3.7.2 (meshes).
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.material.material import Material
from moka.model import schema
from moka.model.accessors import AccessorReader
from moka.model.mesh import (
    ATTRIBUTES,
    INFLUENCES,
    TOPOLOGIES,
    Mesh,
    Primitive,
)
from moka.model.source import GltfSource

if TYPE_CHECKING:
    from moka.model.draco import DecodedPrimitive

__all__ = ["read_meshes"]

_TYPES = {2: ("VEC2",), 3: ("VEC3",), 4: ("VEC4",)}
_UNSIGNED_INT = 5125
_VARIANTS = "KHR_materials_variants"
_FOLLOWING = ("JOINTS_", "WEIGHTS_")
_PLAIN = tuple(name for name in ATTRIBUTES if name not in INFLUENCES)


def read_meshes(source: GltfSource, materials: list[Material]) -> list[Mesh]:
    """All meshes; primitives without positions, which show nothing, are not
    kept (section 3.7.2.1).

    Raises ModelError naming the JSON path of what is wrong.
    """
    if any(view.extensions for view in source.document.buffer_views):
        from moka.model.meshopt import decode_ahead

        decode_ahead(source)
    accessors = AccessorReader(source)
    decoded: dict[str, DecodedPrimitive] = {}
    if any(
        "KHR_draco_mesh_compression" in (primitive.extensions or ())
        for mesh in source.document.meshes
        for primitive in mesh.primitives
    ):
        from moka.model.draco import decode_primitives

        decoded = decode_primitives(source, accessors)
    meshes = []
    for index, mesh in enumerate(source.document.meshes):
        primitives = [
            _read_primitive(
                source,
                accessors,
                materials,
                f"meshes[{index}].primitives[{number}]",
                primitive,
                decoded.get(f"meshes[{index}].primitives[{number}]"),
            )
            for number, primitive in enumerate(mesh.primitives)
            if "POSITION" in primitive.attributes
        ]
        if mesh.target_count or mesh.weights:
            from moka.model.morphs import check_targets

            check_targets(source, f"meshes[{index}]", mesh)
        meshes.append(
            Mesh(mesh.name, primitives, mesh.weights, mesh.target_count)
        )
    return meshes


def _read_primitive(
    source: GltfSource,
    accessors: AccessorReader,
    materials: list[Material],
    path: str,
    primitive: schema.Primitive,
    decoded: "DecodedPrimitive | None",
) -> Primitive:
    if decoded is not None:
        accessors = decoded.accessors
    attributes = {}
    for name in _PLAIN:
        index = primitive.attributes.get(name)
        if index is not None:
            attributes[name] = _read_attribute(
                source, accessors, f"{path}.attributes.{name}", name, index
            )
            _check_count(source, path, name, attributes)
    if "NORMAL" not in attributes:
        # Flat normals take their place, to which tangents do not belong.
        attributes.pop("TANGENT", None)
    if any(name.startswith(_FOLLOWING) for name in primitive.attributes):
        from moka.model.skins import read_influences

        attributes |= read_influences(
            source, accessors, path, primitive, len(attributes["POSITION"])
        )
    targets = None
    if primitive.targets:
        from moka.model.morphs import read_targets

        targets = read_targets(source, accessors, path, primitive, attributes)
    indices, topology = None, TOPOLOGIES[primitive.mode]
    if decoded is not None:
        indices, topology = decoded.indices, Topology.TRIANGLES
    elif primitive.indices is not None:
        _accessor(source, f"{path}.indices", primitive.indices)
        indices = accessors.indices(primitive.indices)
    material = None
    if primitive.material is not None:
        source.check_index(
            f"{path}.material", primitive.material, "materials", len(materials)
        )
        material = materials[primitive.material]
    try:
        read = Primitive(
            attributes,
            indices,
            topology=topology,
            material=material,
            targets=targets,
        )
    except ModelError as error:
        raise source.error(path, str(error)) from error
    if _VARIANTS in (primitive.extensions or ()):
        from moka.model.variants import read_variant_materials

        read.variants = read_variant_materials(
            source, primitive, path, materials
        )
    return read


def _read_attribute(
    source: GltfSource,
    accessors: AccessorReader,
    path: str,
    name: str,
    index: int,
) -> NDArray[np.float32]:
    """One attribute; a colour without alpha becomes opaque."""
    accessor = _accessor(source, path, index)
    types = ("VEC3", "VEC4") if name == "COLOR_0" else _TYPES[ATTRIBUTES[name]]
    if accessor.type not in types:
        raise source.error(
            path,
            f"accessors[{index}] is {accessor.type}, not {' or '.join(types)}",
        )
    if accessor.component_type == _UNSIGNED_INT:
        raise source.error(
            path, f"accessors[{index}] has 32-bit integers, which none may have"
        )
    array = accessors.floats(index)
    if name == "COLOR_0" and accessor.type == "VEC3":
        opaque = np.ones((len(array), 4), np.float32)
        opaque[:, :3] = array
        return opaque
    return array


def _accessor(source: GltfSource, path: str, index: int) -> schema.Accessor:
    accessors = source.document.accessors
    source.check_index(path, index, "accessors", len(accessors))
    return accessors[index]


def _check_count(
    source: GltfSource,
    path: str,
    name: str,
    attributes: dict[str, NDArray[np.float32]],
) -> None:
    """Raise ModelError unless attribute ``name`` fits the positions."""
    count, expected = len(attributes[name]), len(attributes["POSITION"])
    if count != expected:
        raise source.error(
            f"{path}.attributes.{name}",
            f"has {count} elements, POSITION has {expected}",
        )
