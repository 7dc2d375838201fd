"""The node tree against a recursive oracle; scenes; broken hierarchies."""

import json
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from moka.core.errors import ModelError
from moka.model import Model, load_model
from tests.model.files import glb, triangle


def load(
    nodes: list[dict[str, Any]], scenes: list[dict[str, Any]] | None = None
) -> Model:
    document = triangle(nodes=nodes, scenes=scenes or [])
    if not scenes:
        del document["scene"]
    return load_model(glb(document))


def matrix_of(node: dict[str, Any]) -> np.ndarray[Any, Any]:
    """The matrix of a node as the specification words it."""
    if "matrix" in node:
        return np.reshape(node["matrix"], (4, 4)).T
    translation, rotation, scale = np.eye(4), np.eye(4), np.eye(4)
    translation[:3, 3] = node.get("translation", (0, 0, 0))
    rotation[:3, :3] = Rotation.from_quat(
        node.get("rotation", (0, 0, 0, 1))
    ).as_matrix()
    scale[:3, :3] = np.diag(node.get("scale", (1, 1, 1)))
    return translation @ rotation @ scale


numbers = st.floats(-3, 3, allow_nan=False)
unit = st.tuples(numbers, numbers, numbers, numbers).filter(
    lambda q: np.linalg.norm(q) > 0.1
)
transforms = st.one_of(
    st.fixed_dictionaries(
        {},
        optional={
            "translation": st.tuples(numbers, numbers, numbers),
            "rotation": unit.map(lambda q: q / np.linalg.norm(q)).map(list),
            "scale": st.tuples(numbers, numbers, numbers),
        },
    ),
    st.fixed_dictionaries(
        {"matrix": st.lists(numbers, min_size=12, max_size=12)}
    ).map(
        lambda made: {
            "matrix": np.vstack(
                [np.reshape(made["matrix"], (3, 4)), (0, 0, 0, 1)]
            )
            .T.reshape(-1)
            .tolist()
        }
    ),
)


@st.composite
def forests(draw: st.DrawFn) -> tuple[list[dict[str, Any]], list[int]]:
    """Nodes in any order, and the parent of each."""
    count = draw(st.integers(1, 12))
    nodes = [{**draw(transforms), "name": str(index)} for index in range(count)]
    names = draw(st.permutations(range(count)))
    parents = [-1] * count
    for place in range(1, count):
        above = draw(st.integers(-1, place - 1))
        if above >= 0:
            parent = names[above]
            parents[names[place]] = parent
            nodes[parent].setdefault("children", []).append(names[place])
    return nodes, parents


@settings(deadline=None)
@given(forests())
def test_world_matrices_are_products_along_the_tree(
    forest: tuple[list[dict[str, Any]], list[int]],
) -> None:
    nodes, parents = forest

    def world(index: int) -> np.ndarray[Any, Any]:
        local = matrix_of(nodes[index])
        return local if parents[index] < 0 else world(parents[index]) @ local

    tree = load(nodes).nodes
    assert (tree.parents < np.arange(len(tree))).all()
    for row, index in enumerate(tree.source.tolist()):
        assert tree.names[row] == str(index)
        parent = tree.parents[row]
        assert parents[index] == (tree.source[parent] if parent >= 0 else -1)
        np.testing.assert_allclose(
            tree.local[row], matrix_of(nodes[index]), atol=1e-12
        )
    expected = [world(index) for index in tree.source.tolist()]
    np.testing.assert_allclose(
        tree.world_matrices(), expected, rtol=1e-9, atol=1e-6
    )


def chain(count: int) -> list[dict[str, Any]]:
    """Each node the child of the one behind it, the root last."""
    nodes: list[dict[str, Any]] = [
        {"translation": [1, 0, 0], "children": [index - 1]}
        for index in range(count)
    ]
    nodes[0] = {"translation": [1, 0, 0], "mesh": 0}
    return nodes


def test_a_deep_chain_needs_no_recursion() -> None:
    tree = load(chain(5000)).nodes
    assert tree.source.tolist() == list(range(4999, -1, -1))
    x = tree.world_matrices()[:, 0, 3]
    assert x.tolist() == list(range(1, 5001))


@pytest.mark.parametrize("deep", [False, True])
def test_100_000_nodes_load_within_a_second(deep: bool) -> None:
    nodes = chain(100_000)
    if not deep:
        nodes = [{"translation": [1, 0, 0]} for _ in range(100_000)]
        nodes[0]["children"] = list(range(1, 100_000))
    data = json.dumps(
        triangle(
            nodes=nodes,
            scenes=[{"nodes": [99_999 if deep else 0]}],
            meshes=[{"primitives": []}],
        )
    ).encode()
    start = time.process_time()
    model = load_model(data)
    assert time.process_time() - start < 1.0
    assert len(model.nodes) == 100_000


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([{"children": [0]}], "nodes[0]: is on or below a cycle of nodes"),
        (
            [{}, {"children": [2]}, {"children": [1]}],
            "nodes[1]: is on or below a cycle of nodes",
        ),
        (
            [{"children": [2]}, {"children": [2]}, {}],
            "nodes[2]: has two parents, nodes[0] and nodes[1]",
        ),
        (
            [{"children": [1, 1]}, {}],
            "nodes[1]: has two parents, nodes[0] and nodes[0]",
        ),
        (
            [{}, {"children": [0, 2]}],
            "nodes[1].children: there is no nodes[2], the file has 2",
        ),
        ([{"children": [-1]}], "nodes[0].children[0]: expected 'int' >= 0"),
        ([{"mesh": 1}], "nodes[0].mesh: there is no meshes[1]"),
        ([{}, {"camera": 0}], "nodes[1].camera: there is no cameras[0]"),
        (
            [{"extensions": {"KHR_lights_punctual": {"light": 0}}}],
            "nodes[0].extensions.KHR_lights_punctual.light: there is no "
            "lights[0], the file has 0",
        ),
        (
            [{"extensions": {"KHR_lights_punctual": {"light": "sun"}}}],
            "nodes[0].extensions.KHR_lights_punctual.light: expected 'int'",
        ),
        (
            [{"matrix": [1, 2, 3]}],
            "nodes[0].matrix: expected 'array' of length >= 16",
        ),
        (
            [{}, {"translation": [1e200, 0, 0]}],
            "nodes[1]: its matrix is beyond the range of float32",
        ),
        (
            [{"rotation": [0, 0, 0]}],
            "nodes[0].rotation: expected 'array' of length 4",
        ),
    ],
)
def test_names_what_is_wrong(nodes: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(ModelError) as caught:
        load(nodes)
    assert message in str(caught.value)


def test_a_quaternion_of_zero_is_no_rotation() -> None:
    tree = load([{"rotation": [0, 0, 0, 0]}, {"rotation": [0, 0, 0, 1e-200]}])
    assert (tree.nodes.local == np.eye(4)).all()


def test_overflow_below_the_root_warns_of_nothing() -> None:
    big = {"scale": [3e38] * 3}
    nodes = [{**big, "children": [i + 1]} for i in range(20)] + [{"mesh": 0}]
    model = load(nodes)
    assert not np.isfinite(model.nodes.world_matrices()[-1]).all()
    assert model.bounds() is not None


class TestScenes:
    NODES = (
        {"mesh": 0, "children": [1]},
        {"mesh": 0},
        {"mesh": 0},
        {"children": [4]},
        {"mesh": 0},
    )

    def test_only_nodes_of_the_scene_are_instances(self) -> None:
        document = triangle(
            nodes=list(self.NODES),
            scenes=[{"nodes": [0]}, {"nodes": [2, 3], "name": "other"}],
            scene=1,
        )
        model = load_model(glb(document))
        assert model.default_scene == 1
        assert model.scene_names == ["", "other"]

        def shown(scene: int | None) -> set[int]:
            nodes, meshes = model.instances(scene)
            assert not meshes.any()
            return set(model.nodes.source[nodes].tolist())

        assert shown(0) == {0, 1}
        assert shown(1) == shown(None) == {2, 4}

    def test_without_scenes_all_roots_are_one(self) -> None:
        model = load(list(self.NODES))
        assert len(model.scenes) == 1
        assert len(model.instances()[0]) == 4

    def test_the_first_scene_is_the_default(self) -> None:
        document = triangle(scenes=[{"nodes": [0]}, {}])
        del document["scene"]
        assert load_model(glb(document)).default_scene == 0

    def test_a_file_may_hold_nothing(self) -> None:
        model = load_model(b'{"asset": {"version": "2.0"}}')
        assert len(model.instances()[0]) == 0
        assert model.bounds() is None

    @pytest.mark.parametrize("scene", [1, -1])
    def test_there_must_be_such_a_scene(self, scene: int) -> None:
        model = load([{}], [{"nodes": [0]}])
        with pytest.raises(
            ModelError, match=f"there is no scene {scene}; choose from 0 ''"
        ):
            model.instances(scene)

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"scene": 2}, "scene: there is no scenes[2], the file has 1"),
            (
                {"scenes": [{"nodes": [5]}]},
                "scenes[0].nodes[0]: there is no nodes[5], the file has 5",
            ),
            (
                {"scenes": [{"nodes": [0, 1]}]},
                "scenes[0].nodes[1]: nodes[1] has a parent",
            ),
        ],
    )
    def test_names_what_is_wrong(
        self, changes: dict[str, Any], message: str
    ) -> None:
        document = triangle(nodes=list(self.NODES), **changes)
        with pytest.raises(ModelError) as caught:
            load_model(glb(document))
        assert message in str(caught.value)


@settings(deadline=None, max_examples=25)
@given(forests())
def test_bounds_hold_every_transformed_corner(
    forest: tuple[list[dict[str, Any]], list[int]],
) -> None:
    nodes, _ = forest
    model = load([{**node, "mesh": 0} for node in nodes])
    bounds = model.bounds()
    assert bounds is not None
    box = np.array([(x, y, 0, 1) for x in (0, 1) for y in (0, 2)])
    corners = np.einsum("nij,kj->nki", model.nodes.world_matrices(), box)
    corners = corners[..., :3].reshape(-1, 3)
    np.testing.assert_allclose(bounds[0], corners.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(bounds[1], corners.max(axis=0), atol=1e-6)
