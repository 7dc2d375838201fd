"""EXT_mesh_gpu_instancing: instances are rows below their node."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from moka.core.errors import ModelError
from moka.model import Model, load_model
from tests.support.gltf_file import GltfFile

RANDOM = np.random.default_rng(5)
COUNT = 7
TRANSLATION = RANDOM.normal(size=(COUNT, 3))
ROTATION = Rotation.random(COUNT, random_state=5).as_quat()
SCALE = RANDOM.uniform(0.5, 2, size=(COUNT, 3))
ZEROS, ONES = np.zeros((COUNT, 3)), np.ones((COUNT, 3))


def instanced(
    attributes: dict[str, int], file: GltfFile, **node: Any
) -> GltfFile:
    """``file`` with a node whose mesh has instances."""
    file.node(
        name="owner",
        mesh=file.quad(),
        extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}},
        **node,
    )
    return file


def placed(model: Model) -> np.ndarray[Any, Any]:
    """World matrices of what is drawn."""
    nodes, _ = model.instances()
    return model.nodes.world_matrices()[nodes]


def expected(
    translation: Any = ZEROS,
    rotation: Any = None,
    scale: Any = ONES,
) -> np.ndarray[Any, Any]:
    """Translation, rotation and scale, one matrix after the other."""
    made = []
    for row in range(COUNT):
        move, turn, stretch = np.eye(4), np.eye(4), np.eye(4)
        move[:3, 3] = translation[row]
        if rotation is not None:
            turn[:3, :3] = Rotation.from_quat(rotation[row]).as_matrix()
        stretch[:3, :3] = np.diag(scale[row])
        made.append(move @ turn @ stretch)
    return np.array(made)


def test_each_instance_is_placed_within_its_node() -> None:
    file = GltfFile()
    attributes = {
        "TRANSLATION": file.accessor(TRANSLATION),
        "ROTATION": file.accessor(ROTATION),
        "SCALE": file.accessor(SCALE),
        "_ID": file.accessor(np.arange(COUNT), "u2"),
    }
    instanced(attributes, file, translation=[1, 2, 3])
    model = load_model(file.glb())
    parent = np.eye(4)
    parent[:3, 3] = (1, 2, 3)
    wanted = parent @ expected(TRANSLATION, ROTATION, SCALE)
    assert placed(model) == pytest.approx(wanted, abs=1e-6)
    # The file's node stays, without the mesh.
    assert model.nodes.names == ["owner"] + [""] * COUNT
    assert model.nodes.rows_of_file().tolist() == [0]
    assert model.unsupported_extensions == ()


@pytest.mark.parametrize(("dtype", "largest"), [("i1", 127), ("i2", 32767)])
def test_rotations_may_be_normalised_integers(dtype: str, largest: int) -> None:
    file = GltfFile()
    stored = np.round(ROTATION * largest)
    attributes = {"ROTATION": file.accessor(stored, dtype, normalized=True)}
    model = load_model(instanced(attributes, file).glb())
    assert placed(model) == pytest.approx(
        expected(rotation=ROTATION), abs=4 / largest
    )


def test_what_is_not_given_is_the_identity() -> None:
    file = GltfFile()
    attributes = {"_ID": file.accessor(np.arange(COUNT), "u2")}
    model = load_model(instanced(attributes, file).glb())
    assert placed(model) == pytest.approx(expected())


def test_children_and_cameras_have_no_instances() -> None:
    file = GltfFile()
    file.document["cameras"] = [
        {
            "type": "orthographic",
            "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1},
        }
    ]
    attributes = {"TRANSLATION": file.accessor(TRANSLATION)}
    instanced(attributes, file, children=[1], camera=0)
    file.node(mesh=0)
    model = load_model(file.glb())
    assert len(model.instances()[0]) == COUNT + 1
    assert model.camera_instances()[0].tolist() == [0]


def test_instances_keep_the_weights_of_their_node() -> None:
    file = GltfFile()
    attributes = {"TRANSLATION": file.accessor(TRANSLATION)}
    target = file.accessor(np.ones((4, 3)))
    instanced(attributes, file, weights=[0.5])
    file.document["meshes"][0]["primitives"][0]["targets"] = [
        {"POSITION": target}
    ]
    model = load_model(file.glb())
    rows, _ = model.instances()
    assert [model.nodes.weights[row] for row in rows.tolist()] == [
        [0.5]
    ] * COUNT


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({}, "attributes: is empty, so that nothing can be counted"),
        (
            {"TRANSLATION": 0, "SCALE": 1},
            "attributes.SCALE: has 1 elements, TRANSLATION has 2",
        ),
        ({"SCALE": 9}, "attributes.SCALE: there is no accessors[9]"),
        (
            {"ROTATION": 0},
            "attributes.ROTATION: accessors[0] is VEC3, not VEC4",
        ),
        (
            {"ROTATION": 2},
            "attributes.ROTATION: accessors[2] has integers that are not "
            "normalised",
        ),
        (
            {"TRANSLATION": 3},
            "attributes.TRANSLATION: accessors[3] has 32-bit integers",
        ),
        (
            {"TRANSLATION": 4},
            "attributes.TRANSLATION: of instance 1 is not finite",
        ),
    ],
)
def test_says_what_is_wrong(attributes: dict[str, int], message: str) -> None:
    file = GltfFile()
    file.accessor(np.ones((2, 3)))
    file.accessor(np.ones((1, 3)))
    file.accessor(np.ones((2, 4)), "i1")
    file.accessor(np.ones((2, 3)), "u4")
    file.accessor([[0, 0, 0], [0, np.nan, 0]])
    with pytest.raises(ModelError) as caught:
        load_model(instanced(attributes, file).glb())
    text = str(caught.value)
    assert f"nodes[0].extensions.EXT_mesh_gpu_instancing.{message}" in text


def test_animations_move_the_node_of_the_file() -> None:
    """Rows of instances are none of the file's nodes."""
    file = GltfFile()
    attributes = {"TRANSLATION": file.accessor(TRANSLATION)}
    instanced(attributes, file)
    file.node()
    sampler = {
        "input": file.accessor([0, 1], limits=True),
        "output": file.accessor([[0, 0, 0], [1, 0, 0]]),
    }
    target = {"node": 1, "path": "translation"}
    file.document["animations"] = [
        {
            "samplers": [sampler],
            "channels": [{"sampler": 0, "target": target}],
        }
    ]
    model = load_model(file.glb())
    (channel,) = model.animations[0].channels
    assert channel.target.index == model.nodes.rows_of_file()[1]
