"""Skinned and morphed things for tests: a file, and what it must look like.

The file goes through moka's reader and its renderer, the arrays through the
oracle; nothing is shared between the two ways.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.support.gltf_file import GltfFile
from tests.support.oracles.skinning import deform, world_matrices

__all__ = ["Character"]

Array = NDArray[Any]


class Character:
    """N vertices, drawn as points, that follow J joints and T targets.

    Joints are a random tree, posed at random; ``scales`` are the least and
    the greatest scale of a joint, ``mirrored`` turns one axis of the root.
    Every vertex has a colour of its own, whose red is its number by N.
    ``far`` moves everything along all axes, in metres.
    """

    def __init__(
        self,
        *,
        vertices: int = 150,
        joints: int = 6,
        sets: int = 1,
        targets: int = 0,
        active: int = 3,
        scales: tuple[float, float] = (1.0, 1.0),
        mirrored: bool = False,
        morphs_colour: bool = False,
        has_inverse_bind: bool = True,
        far: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.random = random = np.random.default_rng(seed)
        self.count = vertices
        normals = random.normal(size=(vertices, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        colour = np.full((vertices, 4), 0.5, np.float32)
        colour[:, 0] = (np.arange(vertices) + 0.5) / vertices
        self.vertices: dict[str, Array] = {
            "POSITION": random.uniform(-1, 1, (vertices, 3)).astype("f4"),
            "NORMAL": normals.astype("f4"),
            "COLOR_0": colour,
        }
        self.targets: list[dict[str, Array]] = []
        self.weights = np.zeros(targets)
        for _ in range(targets):
            target = {
                "POSITION": random.normal(0, 0.2, (vertices, 3)).astype("f4"),
                "NORMAL": random.normal(0, 0.2, (vertices, 3)).astype("f4"),
            }
            # Most targets move a part of a mesh.
            first, last = sorted(random.integers(0, vertices, 2).tolist())
            for array in target.values():
                array[:first] = array[last:] = 0
            if morphs_colour:
                blue = np.zeros((vertices, 4), np.float32)
                blue[:, 2] = random.uniform(-0.1, 0.1, vertices)
                target["COLOR_0"] = blue
            self.targets.append(target)
        if targets:
            shown = random.choice(targets, min(active, targets), False)
            self.weights[shown] = random.uniform(-0.5, 1, len(shown))
        self.parents = [
            int(random.integers(0, node)) if node else -1
            for node in range(joints)
        ]
        self.local = self._pose(joints, scales)
        if joints:
            self.local[0, :3, 3] += far
            if mirrored:
                self.local[0, :3, :3] *= (1, -1, 1)
        self.joints = random.integers(0, max(joints, 1), (vertices, 4 * sets))
        self.influences = random.dirichlet(
            np.full(4 * sets, 0.5), vertices
        ).astype("f4")
        self.inverse_bind = np.tile(np.eye(4), (joints, 1, 1))
        if has_inverse_bind and joints:
            bind = world_matrices(self.parents, self._pose(joints, (0.8, 1.2)))
            inverse = np.linalg.inv(bind)
            self.inverse_bind = inverse.astype("f4").astype(float)
        self.has_inverse_bind = has_inverse_bind
        self.sets = sets if joints else 0

    def _pose(self, joints: int, scales: tuple[float, float]) -> Array:
        """Local matrices (J, 4, 4) that float32 holds exactly enough."""
        local = np.tile(np.eye(4), (joints, 1, 1))
        turns = Rotation.random(joints, random_state=self.random.integers(99))
        sizes = self.random.uniform(*scales, (joints, 3))
        local[:, :3, :3] = turns.as_matrix() * sizes[:, None]
        local[:, :3, 3] = self.random.uniform(-0.5, 0.5, (joints, 3))
        return local.astype("f4").astype(float)

    def expected(self) -> dict[str, Array]:
        """The vertices in the world, by the oracle."""
        return self._deformed(self.vertices, self.targets)

    def _deformed(
        self, vertices: dict[str, Array], targets: list[dict[str, Array]]
    ) -> dict[str, Array]:
        skinned: dict[str, Any] = {"node_world": np.eye(4)}
        if self.sets:
            skinned = {
                "joints": self.joints,
                "influences": self.influences,
                "joint_world": world_matrices(self.parents, self.local),
                "inverse_bind": self.inverse_bind,
            }
        return deform(
            vertices, targets=targets, weights=self.weights, **skinned
        )

    def expected_positions(self) -> Array:
        """Positions (N, 3) in the world; scales may be 0 here."""
        vertices = {"POSITION": self.vertices["POSITION"]}
        targets = [{"POSITION": each["POSITION"]} for each in self.targets]
        return self._deformed(vertices, targets)["POSITION"]

    def reach_of_boxes(self) -> float:
        """How far from their middle boxes of joints can reach at most.

        The box of all vertices, grown by every target, moved by each joint.
        """
        points = self.vertices["POSITION"].astype(float)
        grown = np.abs(points).max(axis=0)
        for target, weight in zip(self.targets, self.weights, strict=True):
            grown = grown + abs(weight) * np.abs(target["POSITION"]).max(axis=0)
        if not self.sets:
            return float(grown.max())
        matrices = world_matrices(self.parents, self.local) @ self.inverse_bind
        reach = (np.abs(matrices[:, :3, :3]) @ grown).max()
        places = matrices[:, :3, 3]
        return float(reach + np.abs(places - places.mean(axis=0)).max())

    def glb(self) -> bytes:
        """The file; the node of the mesh stands somewhere else."""
        file = GltfFile()
        self.add_to(file)
        return file.glb()

    def add_to(self, file: GltfFile) -> None:
        """Put mesh, skin and nodes into ``file``."""
        mesh = self._add_mesh(file)
        skin = {}
        moved: list[float] = [0, 0, 0]
        if self.sets:
            first = len(file.document["nodes"])
            for node, local in enumerate(self.local):
                children = [
                    first + child
                    for child, parent in enumerate(self.parents)
                    if parent == node
                ]
                file.node(
                    name=f"joint {node}",
                    matrix=local.T.reshape(-1).tolist(),
                    **({"children": children} if children else {}),
                )
            made: dict[str, Any] = {
                "joints": list(range(first, first + len(self.local))),
            }
            if self.has_inverse_bind:
                made["inverseBindMatrices"] = file.accessor(
                    self.inverse_bind.transpose(0, 2, 1).reshape(-1, 16)
                )
            skins = file.document.setdefault("skins", [])
            skins.append(made)
            skin = {"skin": len(skins) - 1}
            moved = [3, 4, 5]  # Means nothing: the joints place the mesh.
        weights = {"weights": self.weights.tolist()} if self.targets else {}
        file.node(mesh=mesh, translation=moved, **skin, **weights)

    def _add_mesh(self, file: GltfFile) -> int:
        mesh = file.mesh(self.vertices, mode=0)
        primitive = file.document["meshes"][mesh]["primitives"][0]
        for number in range(self.sets):
            part = slice(4 * number, 4 * number + 4)
            primitive["attributes"] |= {
                f"JOINTS_{number}": file.accessor(self.joints[:, part], "u1"),
                f"WEIGHTS_{number}": file.accessor(self.influences[:, part]),
            }
        if self.targets:
            primitive["targets"] = [
                {
                    name: file.accessor(array, limits=name == "POSITION")
                    for name, array in target.items()
                }
                for target in self.targets
            ]
        return mesh
