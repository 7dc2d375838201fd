"""Flattened draws against loops over nodes and primitives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.errors import ModelError
from moka.model.mesh import Mesh, Primitive
from moka.model.model import Model
from moka.scene.drawables import Drawables, ModelLayout
from moka.scene.transforms import TransformTree
from tests.scene.models import make_model


@st.composite
def models(draw: st.DrawFn) -> Model:
    counts = draw(st.lists(st.integers(0, 3), min_size=1, max_size=4))
    nodes = draw(st.lists(st.integers(-1, len(counts) - 1), max_size=8))
    parents = [draw(st.integers(-1, i - 1)) for i in range(len(nodes))]
    return make_model(counts, nodes, parents, seed=draw(st.integers(0, 99)))


@given(st.lists(models(), max_size=3), st.data())
def test_draws_are_those_of_a_loop(
    choices: list[Model], data: st.DataObject
) -> None:
    """Also if a model comes twice: then its primitives come once."""
    order = data.draw(st.lists(st.integers(0, 2), max_size=5))
    placed = [choices[i % len(choices)] for i in order if choices]
    layouts = {id(model): ModelLayout(model, None) for model in choices}
    tree = TransformTree()
    rows = [
        tree.add_many(model.nodes.local, model.nodes.parents)
        for model in placed
    ]
    tree.update()
    drawables = Drawables([layouts[id(model)] for model in placed], rows)
    drawables.refresh(tree)
    expected = [
        (position, int(rows[position][node]), primitive)
        for position, model in enumerate(placed)
        for node, mesh in enumerate(model.nodes.mesh)
        if mesh >= 0
        for primitive in model.meshes[mesh].primitives
    ]
    assert len(drawables) == len(expected)
    assert len(set(map(id, drawables.primitives))) == len(drawables.primitives)
    for draw, (owner, row, primitive) in enumerate(expected):
        assert drawables.owner[draw] == owner
        assert drawables.row[draw] == row
        assert drawables.primitives[drawables.primitive[draw]] is primitive
        assert_allclose(drawables.local_bounds[draw], primitive.bounds)
        points = primitive.attributes["POSITION"] @ tree.world[row, :3, :3].T
        points += tree.world[row, :3, 3]
        low, high = drawables.world_bounds[draw]
        assert (low - 1e-5 <= points).all()
        assert (points <= high + 1e-5).all()
        mirrored = np.linalg.det(tree.world[row, :3, :3]) < 0
        assert drawables.mirrored[draw] == mirrored


def test_only_primitives_of_placed_meshes_are_kept() -> None:
    model = make_model([2, 3], [1], [-1])
    layout = ModelLayout(model, None)
    assert layout.primitives == model.meshes[1].primitives


def test_only_what_moved_is_computed() -> None:
    model = make_model([1], [0, 0], [-1, -1])
    tree = TransformTree()
    rows = tree.add_many(model.nodes.local, model.nodes.parents)
    drawables = Drawables([ModelLayout(model, None)], [rows])
    tree.update()
    drawables.refresh(tree)
    drawables.world_bounds[:] = 7
    drawables.refresh(tree)
    assert (drawables.world_bounds == 7).all()
    tree.set_local(int(rows[1]), np.eye(4))
    tree.update()
    drawables.refresh(tree)
    assert (drawables.world_bounds[0] == 7).all()
    assert_allclose(drawables.world_bounds[1], drawables.local_bounds[1])


def test_bounds_of_some_and_of_none() -> None:
    positions = np.array([[0, 0, 0], [1, 2, 3]], np.float32)
    model = make_model([0], [0, 0], [-1, -1])
    model.meshes[0] = Mesh("", [Primitive({"POSITION": positions})])
    model.nodes.local[1, :3, 3] = (10, 0, 0)
    model.nodes.local[:, :3, :3] = np.eye(3)
    model.nodes.local[0, :3, 3] = 0
    tree = TransformTree()
    rows = tree.add_many(model.nodes.local, model.nodes.parents)
    drawables = Drawables([ModelLayout(model, None)], [rows])
    tree.update()
    drawables.refresh(tree)
    both = drawables.bounds(np.array([True, True]))
    assert_allclose(both, [[0, 0, 0], [11, 2, 3]])
    second = drawables.bounds(np.array([False, True]))
    assert_allclose(second, [[10, 0, 0], [11, 2, 3]])
    assert drawables.bounds(np.array([False, False])) is None


def test_a_matrix_that_is_not_affine_names_the_file() -> None:
    model = make_model([1], [0], [-1])
    model.name = "broken"
    model.nodes.local[0, 3, 0] = 1
    with pytest.raises(ModelError, match=r"broken: nodes: .*last row"):
        ModelLayout(model, None)
