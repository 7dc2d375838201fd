"""A model: what a glTF file says, on the CPU."""

from collections.abc import Sequence
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
    ``required_extensions`` those without which it cannot be drawn,
    ``unsupported_extensions`` the optional ones among them that moka leaves
    out, ``omitted`` counts other things that it does not draw, by name.
    ``skins`` are what ``nodes.skins`` number. ``rest_pose`` is where nodes
    are that ``animations`` move; without it their matrices are taken apart.
    ``variants`` are the names of its variants of materials.
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
    required_extensions: tuple[str, ...] = ()
    omitted: dict[str, int] = {}
    animations: "list[Animation]" = []
    rest_pose: "RestPose | None" = None
    skins: "list[Skin]" = []
    variants: tuple[str, ...] = ()

    def scene_index(self, scene: int | str | None) -> int:
        """The number of a scene that is named or numbered.

        None is the default scene. Raises ModelError, listing the scenes, if
        there is none such or there are several.
        """
        if scene is None:
            return self.default_scene
        return self._choice("scene", scene, self.scene_names)

    def variant_index(self, variant: int | str | None) -> int | None:
        """The number of a variant that is named or numbered, None for None.

        Raises ModelError, listing the variants, if there is none such or
        there are several.
        """
        if variant is None:
            return None
        return self._choice("variant", variant, self.variants)

    def _choice(
        self, what: str, choice: int | str, names: Sequence[str]
    ) -> int:
        where = self.path or self.name or "a model"
        if isinstance(choice, str):
            found = [i for i, name in enumerate(names) if name == choice]
        else:
            found = [choice] if 0 <= choice < len(names) else []
        if len(found) == 1:
            return found[0]
        if not names:
            raise ModelError(f"{where}: the model has no {what}s")
        listed = ", ".join(f"{i} {name!r}" for i, name in enumerate(names))
        raise ModelError(
            f"{where}: there {'are several' if found else 'is no'} {what} "
            f"{choice!r}; choose from {listed}"
        )

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

        In metres, from the boxes of the primitives, and with skins and
        morph targets as the file has them; None if the scene shows nothing.
        """
        nodes, meshes = self.instances(scene)
        boxes = np.array([_box(mesh) for mesh in self.meshes])
        shown = np.array([bool(mesh.primitives) for mesh in self.meshes])
        if not len(nodes) or not shown[meshes].any():
            return None
        nodes, meshes = nodes[shown[meshes]], meshes[shown[meshes]]
        world = self.nodes.world_matrices()
        moves = np.array([bool(mesh.target_count) for mesh in self.meshes])
        posed = moves[meshes] | np.isin(nodes, list(self.nodes.skins))
        # Matrices that overflowed along the tree give boxes without end.
        with np.errstate(invalid="ignore", over="ignore"):
            placed = transform_bounds(
                world[nodes[~posed]], boxes[meshes[~posed]]
            )
            if not posed.any():
                return union_bounds(placed)
            from moka.model.posed_bounds import posed_bounds

            others = [
                posed_bounds(
                    self.nodes, world, row, self.meshes[mesh], self.skins
                )
                for row, mesh in zip(
                    nodes[posed].tolist(), meshes[posed].tolist(), strict=True
                )
            ]
            return union_bounds(np.concatenate([placed, others]))

    def _placed(self, what: NDArray[np.int32], scene: int | None) -> Placements:
        inside = np.isin(
            self.nodes.roots(), self.scenes[self.scene_index(scene)]
        )
        rows = np.flatnonzero(inside & (what >= 0)).astype(np.int32)
        return rows, what[rows]


def _box(mesh: Mesh) -> Array:
    """The box (2, 3) of a mesh in its own space, NaN if it shows nothing."""
    if not mesh.primitives:
        return np.full((2, 3), np.nan)
    return union_bounds([primitive.bounds for primitive in mesh.primitives])
