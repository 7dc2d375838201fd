"""Poses in a scene: boxes that hold every vertex, and who changed when."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from moka.core.errors import ModelError
from moka.model import load_model
from moka.model.model import Model
from moka.scene.poses import Poses
from moka.scene.scene import Scene
from tests.support.characters import Character
from tests.support.gltf_file import GltfFile

KINDS = st.fixed_dictionaries(
    {
        "joints": st.integers(0, 12),
        "sets": st.integers(1, 3),
        "targets": st.integers(0, 5),
        "scales": st.sampled_from([(1.0, 1.0), (0.3, 2.0), (0.0, 1.0)]),
        "mirrored": st.booleans(),
        "has_inverse_bind": st.booleans(),
        "far": st.sampled_from([0.0, 1e6]),
        "seed": st.integers(0, 1000),
    }
)


def poses_of(scene: Scene) -> Poses:
    poses = scene.drawables.poses
    assert poses is not None
    return poses


def load(character: Character) -> Model:
    return load_model(character.glb())


def box_of(points: NDArray[Any]) -> NDArray[Any]:
    return np.stack([points.min(axis=0), points.max(axis=0)])


@settings(max_examples=60, deadline=None)
@given(KINDS)
def test_boxes_hold_every_vertex_and_are_not_absurd(
    kind: dict[str, Any],
) -> None:
    character = Character(vertices=40, **kind)
    positions = character.expected_positions()
    model = load(character)
    scene = Scene()
    scene.add(model)
    for found in (scene.bounds(), model.bounds()):
        assert found is not None
        true = box_of(positions)
        size = np.abs(positions - positions.mean(axis=0)).max()
        # The vertices' own float32, and that of weights.
        rounding = 1e-6 * (size + 1)
        assert (found[0] <= true[0] + rounding).all()
        assert (found[1] >= true[1] - rounding).all()
        # Each joint's box, turned, and each target's extents at once.
        worst = character.reach_of_boxes()
        assert (found[1] - found[0] <= 2 * worst + rounding).all()


def test_a_still_pose_is_not_computed_again() -> None:
    scene = Scene()
    placed = scene.add(load(Character(joints=4, targets=3)))
    scene.update()
    poses = poses_of(scene)
    before = (scene.pose_version, poses.skins.version.tolist())
    scene.update()
    assert (scene.pose_version, poses.skins.version.tolist()) == before
    # What moves and is no joint changes no pose.
    other = scene.add(load_model(GltfFileOfQuad().glb()))
    scene.update()
    poses = poses_of(scene)
    version = scene.pose_version
    other.transform.translate((1, 0, 0))
    scene.update()
    assert scene.pose_version == version
    placed.node(0).translate((0, 0.5, 0))
    scene.update()
    assert scene.pose_version == version + 1
    assert placed.morph_weights is not None
    mesh_node = int(np.flatnonzero(placed.model.nodes.mesh >= 0)[0])
    placed.morph_weights.set(mesh_node, (0.1, 0.2, 0.3))
    scene.update()
    assert scene.pose_version == version + 2


class GltfFileOfQuad(GltfFile):
    """A square, which no joint moves."""

    def __init__(self) -> None:
        super().__init__()
        self.node(mesh=self.quad())


def test_only_the_skin_whose_joint_moved_changes() -> None:
    scene = Scene()
    model = load(Character(joints=5))
    placed = [scene.add(model) for _ in range(3)]
    scene.update()
    skins = poses_of(scene).skins
    before = skins.version.copy()
    matrices = skins.matrices.copy()
    placed[1].node(2).translate((0.25, 0, 0))
    scene.update()
    assert (skins.version - before).tolist() == [0, 1, 0]
    same = np.ones(len(matrices), np.bool_)
    same[5:10] = False
    np.testing.assert_array_equal(skins.matrices[same], matrices[same])
    assert not np.array_equal(skins.matrices[5:10], matrices[5:10])
    # As if all had been computed anew.
    fresh = Scene()
    for other in placed:
        copy = fresh.add(model)
        for row in range(len(model.nodes)):
            copy.node(row).local_matrix = other.node(row).local_matrix
    np.testing.assert_allclose(fresh.bounds(), scene.bounds(), rtol=1e-12)


def test_the_node_of_a_skinned_mesh_means_nothing() -> None:
    scene = Scene()
    placed = scene.add(load(Character(joints=4)))
    before = scene.bounds()
    version = scene.pose_version
    mesh_node = int(np.flatnonzero(placed.model.nodes.mesh >= 0)[0])
    placed.node(mesh_node).translate((100, 0, 0))
    np.testing.assert_array_equal(scene.bounds(), before)
    assert scene.pose_version == version


def test_a_mesh_without_a_skin_is_rigid_although_it_names_joints() -> None:
    file = GltfFile()
    character = Character(joints=4)
    character.add_to(file)
    nodes = file.document["nodes"]
    mesh = nodes[-1]["mesh"]
    file.node(mesh=mesh, translation=[0, 50, 0])
    scene = Scene()
    scene.add(load_model(file.glb()))
    scene.update()
    skinned, rigid = np.argsort(-poses_of(scene).skin)
    assert poses_of(scene).skin[[skinned, rigid]].tolist() == [0, -1]
    primitives = scene.drawables.primitives
    sets = [
        primitives[scene.drawables.primitive[draw]].influence_sets
        for draw in (skinned, rigid)
    ]
    assert sets == [1, 0]
    points = character.vertices["POSITION"] + np.array([0.0, 50.0, 0.0])
    np.testing.assert_allclose(
        scene.drawables.world_bounds[rigid], box_of(points), rtol=1e-6
    )


@pytest.mark.parametrize("joints", [0, 5])
def test_what_narrowing_keeps_is_posed_as_before(joints: int) -> None:
    scene = Scene()
    model = load(Character(joints=joints, targets=2))
    for place in range(3):
        scene.add(model).transform.translate((10 * place, 0, 0))
    scene.update()
    boxes = scene.drawables.world_bounds.copy()
    kept = np.array([False, True, True])
    made = scene.drawables.only(kept)
    made.refresh(scene.transforms)
    np.testing.assert_array_equal(made.world_bounds, boxes[kept])
    assert made.poses is not None
    assert made.poses.skin.tolist() == ([0, 1] if joints else [-1, -1])


def test_a_mirrored_skeleton_turns_front_faces() -> None:
    for mirrored in (False, True):
        scene = Scene()
        character = Character(joints=1, has_inverse_bind=False)
        character.local[0, :3, :3] = np.diag([1, -1 if mirrored else 1, 1])
        scene.add(load(character))
        scene.update()
        assert scene.drawables.mirrored.tolist() == [mirrored]


def test_a_plain_scene_has_no_poses() -> None:
    scene = Scene()
    scene.add(load_model(GltfFileOfQuad().glb()))
    scene.update()
    assert scene.drawables.poses is None
    assert scene.pose_version == 0


def test_a_joint_that_is_not_there_is_an_error() -> None:
    """In a model made in memory; those of files are checked when read."""
    model = load(Character(joints=5))
    model.skins[0].joints = model.skins[0].joints[:2]
    model.skins[0].inverse_bind = model.skins[0].inverse_bind[:2]
    scene = Scene()
    scene.add(model)
    with pytest.raises(ModelError, match="joint that its skin lacks"):
        scene.update()
