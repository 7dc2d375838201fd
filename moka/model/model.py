"""A model: what a glTF file says, on the CPU."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.core.maths import Array, transform_bounds, union_bounds
from moka.material.material import Material
from moka.model.cameras import CameraDescription
from moka.model.lights import PunctualLight
from moka.model.mesh import Mesh
from moka.model.nodes import NodeTree

if TYPE_CHECKING:
    from moka.model.animation import Animation, RestPose
    from moka.model.skins import Skin

__all__ = ["Model"]

Placements = tuple[NDArray[np.int32], NDArray[np.int32]]


class Model(Struct, eq=False):
    """Meshes, materials, cameras, lights, and the nodes that place them.

    ``scenes`` are lists of rows of root nodes in ``nodes``; a file without
    scenes has one of all its roots. ``path`` is None for a model that came
    from memory. ``extensions`` are those that the file uses,
    ``unsupported_extensions`` the optional ones among them that moka leaves
    out, ``omitted`` counts other things that it does not draw, by name.
    ``skins`` are what ``nodes.skins`` number. ``rest_pose`` is where nodes
    are that ``animations`` move; without it their matrices are taken apart.
    """

    name: str
    nodes: NodeTree
    meshes: list[Mesh]
    materials: list[Material]
    cameras: list[CameraDescription]
    lights: list[PunctualLight]
    scenes: list[list[int]]
    scene_names: list[str]
    default_scene: int = 0
    path: Path | None = None
    extensions: tuple[str, ...] = ()
    unsupported_extensions: tuple[str, ...] = ()
    omitted: dict[str, int] = {}
    animations: "list[Animation]" = []
    rest_pose: "RestPose | None" = None
    skins: "list[Skin]" = []

    def instances(self, scene: int | None = None) -> Placements:
        """Rows of nodes that show a mesh, and the indices of their meshes.

        Only nodes of ``scene`` (by default ``default_scene``) count. Raises
        ModelError if there is no such scene.
        """
        return self._placed(self.nodes.mesh, scene)

    def camera_instances(self, scene: int | None = None) -> Placements:
        """Rows of nodes that place a camera, and the cameras' indices."""
        return self._placed(self.nodes.camera, scene)

    def light_instances(self, scene: int | None = None) -> Placements:
        """Rows of nodes that place a light, and the lights' indices."""
        return self._placed(self.nodes.light, scene)

    def bounds(self, scene: int | None = None) -> Array | None:
        """The world box (2, 3), least and greatest corner, of a scene.

        In metres, from the boxes of the primitives; None if the scene shows
        nothing.
        """
        nodes, meshes = self.instances(scene)
        boxes = np.array([_box(mesh) for mesh in self.meshes])
        shown = np.array([bool(mesh.primitives) for mesh in self.meshes])
        if not len(nodes) or not shown[meshes].any():
            return None
        kept = shown[meshes]
        world = self.nodes.world_matrices()[nodes[kept]]
        # Matrices that overflowed along the tree give boxes without end.
        with np.errstate(invalid="ignore", over="ignore"):
            return union_bounds(transform_bounds(world, boxes[meshes[kept]]))

    def _placed(self, what: NDArray[np.int32], scene: int | None) -> Placements:
        index = self.default_scene if scene is None else scene
        if not 0 <= index < len(self.scenes):
            raise ModelError(
                f"{self.path or self.name}: there is no scene {index}, the "
                f"model has {len(self.scenes)}"
            )
        inside = np.isin(self.nodes.roots(), self.scenes[index])
        rows = np.flatnonzero(inside & (what >= 0)).astype(np.int32)
        return rows, what[rows]


def _box(mesh: Mesh) -> Array:
    """The box (2, 3) of a mesh in its own space, NaN if it shows nothing."""
    if not mesh.primitives:
        return np.full((2, 3), np.nan)
    return union_bounds([primitive.bounds for primitive in mesh.primitives])
