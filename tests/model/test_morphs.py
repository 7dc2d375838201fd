"""Morph targets as files have them: deltas, counts and weights."""

from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model.load import load_model
from moka.model.morphs import MorphTargets
from tests.model.files import changed, glb, mesh_document, triangle

TARGETS = [{"POSITION": 0}, {"POSITION": 0}]
MORPHED = changed("meshes[0].primitives[0].targets", TARGETS, triangle())


def test_targets_and_weights_are_counted() -> None:
    document = changed("meshes[0].weights", [0.25, 0.5], MORPHED)
    document = changed("nodes[0].weights", [1, 0], document)
    model = load_model(glb(document))
    assert model.meshes[0].target_count == 2
    assert model.meshes[0].weights == [0.25, 0.5]
    assert model.nodes.weights == {0: [1, 0]}


@pytest.mark.parametrize(
    ("path", "value", "where", "what"),
    [
        ("meshes[0].weights", [1], "meshes[0].weights", "are 1 for 2 morph"),
        ("nodes[0].weights", [1, 2, 3], "nodes[0].weights", "are 3 for 2"),
        ("nodes[0].weights", [0, 1e30], "nodes[0].weights", "are beyond"),
        (
            "meshes[0].primitives[1]",
            {"attributes": {"POSITION": 0}, "targets": TARGETS[:1]},
            "meshes[0].primitives[1].targets",
            "are 1, those of the first primitive are 2",
        ),
        ("nodes[1]", {"weights": [1]}, "nodes[1].weights", "has none"),
    ],
)
def test_counts_that_disagree_are_errors(
    path: str, value: Any, where: str, what: str
) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value, MORPHED)))
    assert f"{where}: " in str(caught.value)
    assert what in str(caught.value)
    assert "\n" not in str(caught.value)


def random_targets(count: int, vertices: int) -> MorphTargets:
    random = np.random.default_rng(count)
    return MorphTargets(
        [
            {"POSITION": random.normal(size=(vertices, 3)).astype(np.float32)}
            for _ in range(count)
        ]
    )


def test_the_spread_holds_all_that_targets_can_add() -> None:
    targets = random_targets(7, 50)
    weights = np.random.default_rng(1).normal(size=(20, 7)).astype(np.float32)
    deltas = np.array([each["POSITION"] for each in targets.deltas], np.float64)
    moved = np.einsum("wt,tvc->wvc", weights.astype(np.float64), deltas)
    spread = targets.spread(weights)
    assert (moved >= spread[:, None, 0] - 1e-12).all()
    assert (moved <= spread[:, None, 1] + 1e-12).all()
    one = np.eye(7, dtype=np.float32)
    np.testing.assert_allclose(
        targets.spread(one), targets.extents, rtol=0, atol=0
    )


def test_deltas_follow_their_vertices() -> None:
    targets = random_targets(2, 5)
    kept = np.array([4, 4, 0])
    chosen = targets.of_vertices(kept)
    for one, two in zip(targets.deltas, chosen.deltas, strict=True):
        np.testing.assert_array_equal(one["POSITION"][kept], two["POSITION"])
    assert not targets.without({"POSITION"}).attributes


def test_sparse_quantised_and_foreign_deltas() -> None:
    """Zeros but for one vertex; bytes as -1..1; no base, no delta."""
    positions = np.zeros((3, 3), "f4")
    uv = np.array([(-127, 127)] * 3, "i1")
    uv_padded = np.zeros((3, 4), "i1")
    uv_padded[:, :2] = uv
    document, binary = mesh_document(
        {"POSITION": positions, "TEXCOORD_0": positions[:, :2].copy()}
    )
    views, start = document["bufferViews"], len(binary)
    views += [
        {"buffer": 0, "byteOffset": start, "byteLength": 12, "byteStride": 4},
        {"buffer": 0, "byteOffset": start + 12, "byteLength": 2},
        {"buffer": 0, "byteOffset": start + 16, "byteLength": 12},
    ]
    binary += uv_padded.tobytes() + np.array([2], "<u2").tobytes() + b"\0\0"
    binary += np.array([1, 2, 3], "<f4").tobytes()
    document["buffers"] = [{"byteLength": len(binary)}]
    document["accessors"] += [
        {
            "bufferView": len(views) - 3,
            "componentType": 5120,
            "normalized": True,
            "count": 3,
            "type": "VEC2",
        },
        {
            "componentType": 5126,
            "count": 3,
            "type": "VEC3",
            "sparse": {
                "count": 1,
                "indices": {
                    "bufferView": len(views) - 2,
                    "componentType": 5123,
                },
                "values": {"bufferView": len(views) - 1},
            },
        },
    ]
    document["meshes"][0]["primitives"][0]["targets"] = [
        {"TEXCOORD_0": 2},
        {"POSITION": 3, "NORMAL": 3},
    ]
    targets = load_model(glb(document, binary)).meshes[0].primitives[0].targets
    assert targets is not None
    first, second = targets.deltas
    assert first["TEXCOORD_0"].tolist() == [[-1, 1]] * 3
    assert second.keys() == {"POSITION"}
    assert second["POSITION"].tolist() == [[0, 0, 0], [0, 0, 0], [1, 2, 3]]


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        ([{"POSITION": 9}], "targets[0].POSITION: there is no accessors[9]"),
        ([{"POSITION": 1}], "targets[0].POSITION: accessors[1] is SCALAR, not"),
        ([{}, {"POSITION": 2}], "targets[1].POSITION: has 2 elements, POSIT"),
    ],
)
def test_broken_targets_are_named_in_one_line(
    targets: list[dict[str, int]], message: str
) -> None:
    document = changed("meshes[0].primitives[0].targets", targets, triangle())
    short = {**document["accessors"][0], "count": 2}
    document = changed("accessors[2]", short, document)
    with pytest.raises(ModelError) as caught:
        load_model(glb(document))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_deltas_that_are_not_finite_are_named(wrong: float) -> None:
    positions = np.zeros((3, 3), "f4")
    deltas = np.array([(0, 0, 0), (0, wrong, 0), (0, 0, 0)], "f4")
    document, binary = mesh_document(
        {"POSITION": positions, "NORMAL": deltas}, targets=[{"POSITION": 1}]
    )
    del document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]
    with pytest.raises(ModelError, match="POSITION of target 0 has entries"):
        load_model(glb(document, binary))


def test_a_colour_without_alpha_adds_none() -> None:
    grey = np.full((3, 3), 0.25, "f4")
    document, binary = mesh_document(
        {"POSITION": np.zeros((3, 3), "f4"), "COLOR_0": grey},
        targets=[{"COLOR_0": 1}],
    )
    targets = load_model(glb(document, binary)).meshes[0].primitives[0].targets
    assert targets is not None
    assert targets.deltas[0]["COLOR_0"].tolist() == [[0.25] * 3 + [0]] * 3
