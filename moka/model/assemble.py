"""Models made in memory, of primitives, materials and matrices."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from moka.core.errors import ModelError
from moka.core.maths import Array
from moka.material.material import Material
from moka.model.cameras import CameraDescription
from moka.model.lights import PunctualLight
from moka.model.mesh import Mesh, Primitive
from moka.model.model import Model
from moka.model.nodes import NodeTree

__all__ = ["model_of"]


def model_of(
    items: Iterable[tuple[Primitive, Material | None, ArrayLike]],
    *,
    name: str = "",
    cameras: Iterable[tuple[CameraDescription, ArrayLike]] = (),
    lights: Iterable[tuple[PunctualLight, ArrayLike]] = (),
) -> Model:
    """A model of primitives, each with a material and a (4, 4) matrix.

    Matrices go from the item's space to the model's, indexed [row, column].
    Every pair of a primitive and a material becomes one mesh, which all its
    items share; primitives keep sharing their arrays. Cameras and lights
    have matrices too. Raises ModelError for matrices of another shape or
    with entries that are not finite.
    """
    meshes: dict[tuple[int, int], int] = {}
    model_meshes: list[Mesh] = []
    materials: dict[int, Material] = {}
    # Kept until the end, so that no id is given out twice.
    placed = list(items)
    mesh_of_node = []
    for primitive, material, _ in placed:
        key = id(primitive), id(material)
        if key not in meshes:
            meshes[key] = len(model_meshes)
            model_meshes.append(Mesh("", [primitive.with_material(material)]))
            if material is not None:
                materials[id(material)] = material
        mesh_of_node.append(meshes[key])
    camera_list, light_list = list(cameras), list(lights)
    counts = len(placed), len(camera_list), len(light_list)
    total = sum(counts)
    mesh, camera, light = np.full((3, total), -1, np.int32)
    first_camera, first_light = counts[0], counts[0] + counts[1]
    mesh[:first_camera] = mesh_of_node
    camera[first_camera:first_light] = np.arange(counts[1])
    light[first_light:] = np.arange(counts[2])
    matrices = [
        *(item[2] for item in placed),
        *(item[1] for item in camera_list),
        *(item[1] for item in light_list),
    ]
    nodes = NodeTree(
        names=[""] * first_camera
        + [description.name for description, _ in camera_list]
        + [description.name for description, _ in light_list],
        parents=np.full(total, -1, np.int32),
        local=_matrices(matrices),
        mesh=mesh,
        camera=camera,
        light=light,
        source=np.arange(total, dtype=np.int32),
    )
    return Model(
        name=name,
        nodes=nodes,
        meshes=model_meshes,
        materials=list(materials.values()),
        cameras=[description for description, _ in camera_list],
        lights=[description for description, _ in light_list],
        scenes=[list(range(total))],
        scene_names=[name],
    )


def _matrices(matrices: list[ArrayLike]) -> Array:
    try:
        array = np.array(matrices, np.float64).reshape(len(matrices), 4, 4)
    except ValueError as error:
        raise ModelError("a model needs matrices of 4 x 4 numbers") from error
    if not np.isfinite(array).all():
        raise ModelError("a model needs matrices of finite numbers")
    return array
