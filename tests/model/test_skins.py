"""Skins as files have them: joints, influences in sets, broken ones."""

from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model.load import load_model
from moka.model.mesh import Primitive
from moka.model.model import Model
from moka.model.skins import joint_boxes
from tests.model.files import (
    TRIANGLE_POSITIONS,
    Document,
    changed,
    glb,
    mesh_document,
)

JOINTS = np.array([(0, 1, 0, 0), (1, 0, 0, 0), (1, 2, 0, 0)], "u1")
WEIGHTS = np.array([(0.5, 0.5, 0, 0), (1, 0, 0, 0), (0.75, 0.25, 0, 0)], "f4")


def skinned(**arrays: np.ndarray[Any, Any]) -> tuple[Document, bytes]:
    """A triangle that follows three joints, below one another."""
    given = {
        "POSITION": TRIANGLE_POSITIONS,
        "JOINTS_0": JOINTS,
        "WEIGHTS_0": WEIGHTS,
        **arrays,
    }
    document, binary = mesh_document(given)
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    for name, index in attributes.items():
        if name.startswith("JOINTS"):
            document["accessors"][index]["normalized"] = False
    document["nodes"] = [
        {"mesh": 0, "skin": 0, "children": [1]},
        {"name": "hip", "children": [2]},
        {"name": "knee", "children": [3], "translation": [0, 1, 0]},
        {"name": "toe"},
    ]
    document["skins"] = [{"name": "leg", "joints": [3, 1, 2]}]
    return document, binary


def load(**arrays: np.ndarray[Any, Any]) -> Model:
    return load_model(glb(*skinned(**arrays)))


def primitive_of(model: Model) -> Primitive:
    return model.meshes[0].primitives[0]


def test_joints_are_rows_of_nodes_and_no_matrices_mean_the_identity() -> None:
    model = load()
    (skin,) = model.skins
    assert skin.name == "leg"
    assert [model.nodes.names[row] for row in skin.joints] == [
        "toe",
        "hip",
        "knee",
    ]
    np.testing.assert_array_equal(skin.inverse_bind, [np.eye(4)] * 3)
    assert model.nodes.skins == {0: 0}
    primitive = primitive_of(model)
    assert primitive.influence_sets == 1
    np.testing.assert_array_equal(primitive.attributes["JOINTS_0"], JOINTS)
    np.testing.assert_array_equal(primitive.attributes["WEIGHTS_0"], WEIGHTS)
    assert primitive.as_rigid().influence_sets == 0


@pytest.mark.parametrize("kind", ["u1", "u2"])
def test_integers_are_normalised(kind: str) -> None:
    most = np.iinfo(kind).max
    whole = np.array([(most, 0, 0, 0)] * 3, kind)
    attributes = primitive_of(
        load(JOINTS_0=JOINTS.astype(kind), WEIGHTS_0=whole)
    ).attributes
    assert attributes["WEIGHTS_0"].tolist() == [[1, 0, 0, 0]] * 3
    # What has no weight follows nobody.
    assert attributes["JOINTS_0"].tolist() == [
        [0, 0, 0, 0],
        [1, 0, 0, 0],
        [1, 0, 0, 0],
    ]


def test_weights_are_scaled_to_a_sum_of_one() -> None:
    weights = np.array([(1, 1, 0, 0), (0, 0, 0, 0), (0.2, 0.2, 0, 0)], "f4")
    attributes = primitive_of(load(WEIGHTS_0=weights)).attributes
    np.testing.assert_array_equal(
        attributes["WEIGHTS_0"],
        [(0.5, 0.5, 0, 0), (1, 0, 0, 0), (0.5, 0.5, 0, 0)],
    )
    assert attributes["JOINTS_0"][1].tolist() == [1, 0, 0, 0]


def test_several_sets_become_as_few_as_hold_them() -> None:
    """The strongest of eight first; what has no weight takes no place."""
    second = {
        "JOINTS_1": np.array([(2, 0, 0, 0)] * 3, "u1"),
        "WEIGHTS_1": np.array([(1, 0, 0, 0)] * 3, "f4"),
    }
    primitive = primitive_of(load(**second))
    assert primitive.influence_sets == 1
    np.testing.assert_allclose(
        primitive.attributes["WEIGHTS_0"],
        [(0.5, 0.25, 0.25, 0), (0.5, 0.5, 0, 0), (0.5, 0.375, 0.125, 0)],
    )
    assert primitive.attributes["JOINTS_0"].tolist() == [
        [2, 0, 1, 0],
        [1, 2, 0, 0],
        [2, 1, 2, 0],
    ]


def test_of_more_than_twelve_joints_the_strongest_count() -> None:
    weights = np.arange(16, 0, -1).astype("f4")
    sets = {}
    for number in range(4):
        part = weights[4 * number : 4 * number + 4]
        sets[f"JOINTS_{number}"] = np.full((3, 4), number % 3, "u2")
        sets[f"WEIGHTS_{number}"] = np.tile(part, (3, 1))
    primitive = primitive_of(load(**sets))
    assert primitive.influence_sets == 3
    found = np.hstack(
        [primitive.attributes[f"WEIGHTS_{number}"] for number in range(3)]
    )
    np.testing.assert_allclose(
        found, np.tile(weights[:12] / weights[:12].sum(), (3, 1)), rtol=1e-6
    )


def test_boxes_hold_the_vertices_of_each_joint() -> None:
    boxes = joint_boxes(primitive_of(load()))
    assert boxes.joints.tolist() == [0, 1, 2]
    points = TRIANGLE_POSITIONS
    np.testing.assert_array_equal(boxes.boxes[0], [points[0], points[0]])
    np.testing.assert_array_equal(
        boxes.boxes[1], [points.min(axis=0), points.max(axis=0)]
    )
    np.testing.assert_array_equal(boxes.boxes[2], [points[2], points[2]])


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("skins[0].joints", [9, 1, 2], "skins[0].joints[0]: there is no nod"),
        ("skins[0].joints", [], "skins[0].joints: expected"),
        ("skins[0].joints", [1, 2], "nodes[0].skin: meshes[0] follows joint 2"),
        ("nodes[0].skin", 4, "nodes[0].skin: there is no skins[4]"),
        ("nodes[1].skin", 0, "nodes[1].skin: moves a mesh, and the node has"),
        (
            "skins[0].inverseBindMatrices",
            0,
            "skins[0].inverseBindMatrices: accessors[0] must be MAT4",
        ),
        (
            "skins[0].inverseBindMatrices",
            99,
            "skins[0].inverseBindMatrices: there is no accessors[99]",
        ),
        (
            "meshes[0].primitives[0].attributes",
            {"POSITION": 0, "JOINTS_0": 1},
            "meshes[0].primitives[0].attributes: has no WEIGHTS_0",
        ),
        (
            "meshes[0].primitives[0].attributes",
            {"POSITION": 0, "JOINTS_1": 1, "WEIGHTS_1": 2},
            "meshes[0].primitives[0].attributes: has no JOINTS_0",
        ),
        (
            "meshes[0].primitives[0].attributes",
            {"POSITION": 0},
            "nodes[0].skin: meshes[0] has no JOINTS_0",
        ),
        (
            "meshes[0].primitives[0].attributes.WEIGHTS_0",
            0,
            "attributes.WEIGHTS_0: accessors[0] must be VEC4 of floats or",
        ),
        (
            "meshes[0].primitives[0].attributes.JOINTS_0",
            2,
            "attributes.JOINTS_0: accessors[2] must be VEC4 of plain",
        ),
        (
            "accessors[1].count",
            2,
            "attributes.JOINTS_0: has 2 elements, POSITION has 3",
        ),
    ],
)
def test_what_is_broken_is_named_in_one_line(
    path: str, value: Any, message: str
) -> None:
    document, binary = skinned()
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value, document), binary))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("wrong", [-0.5, np.nan, np.inf])
def test_weights_that_are_none_are_errors(wrong: float) -> None:
    weights = WEIGHTS.copy()
    weights[1, 2] = wrong
    with pytest.raises(ModelError, match=r"WEIGHTS_0: vertex 1 has a weight"):
        load(WEIGHTS_0=weights)


def test_inverse_bind_matrices_are_read_by_columns() -> None:
    document, binary = skinned()
    matrices = np.arange(48, dtype="f4").reshape(3, 4, 4)
    matrices[:, 3] = 0, 0, 0, 1
    start = len(binary)
    document["bufferViews"].append(
        {"buffer": 0, "byteOffset": start, "byteLength": 192}
    )
    document["accessors"].append(
        {
            "bufferView": len(document["bufferViews"]) - 1,
            "componentType": 5126,
            "count": 3,
            "type": "MAT4",
        }
    )
    document["skins"][0]["inverseBindMatrices"] = len(document["accessors"]) - 1
    binary += matrices.transpose(0, 2, 1).tobytes()
    document["buffers"] = [{"byteLength": len(binary)}]
    model = load_model(glb(document, binary))
    np.testing.assert_array_equal(model.skins[0].inverse_bind, matrices)
    last = len(document["accessors"]) - 1
    short = changed(f"accessors[{last}].count", 2, document)
    with pytest.raises(ModelError, match="has 2 matrices for 3 joints"):
        load_model(glb(short, binary))
