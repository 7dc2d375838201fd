"""The arrays of transforms against a recursion over every node."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from moka.core.errors import OptionError
from moka.scene.transforms import TransformTree


def random_matrices(seed: int, count: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3] = random.uniform(-1, 1, (count, 3, 4))
    return matrices


def translation(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def world_by_recursion(tree: TransformTree, row: int) -> np.ndarray:
    parent = tree.parents[row]
    if parent < 0:
        return np.array(tree.local[row])
    return world_by_recursion(tree, parent) @ tree.local[row]


def check(tree: TransformTree) -> None:
    """Every living row is where the recursion puts it."""
    for row in np.flatnonzero(tree.alive):
        expected = world_by_recursion(tree, row)
        assert_allclose(tree.world[row], expected, atol=1e-12)
        assert_allclose(tree.world_of(row), expected, atol=1e-12)


@st.composite
def parent_lists(draw: st.DrawFn) -> list[int]:
    count = draw(st.integers(1, 30))
    return [draw(st.integers(-1, i - 1)) for i in range(count)]


actions = st.lists(
    st.tuples(
        st.sampled_from(["edit", "attach", "grow", "remove", "update"]),
        st.integers(0, 10**6),
        st.integers(0, 10**6),
    ),
    max_size=12,
)


@given(parent_lists(), actions, st.integers(0, 2**32 - 1))
def test_worlds_are_right_after_any_history(
    parents: list[int], history: list[tuple[str, int, int]], seed: int
) -> None:
    tree = TransformTree()
    tree.add_many(random_matrices(seed, len(parents)), parents)
    for action, one, two in history:
        rows = np.flatnonzero(tree.alive)
        row = int(rows[one % len(rows)])
        other = int(rows[two % len(rows)])
        if action == "edit":
            tree.set_local(row, random_matrices(one, 1)[0])
        elif action == "attach" and row not in tree.subtree(other):
            tree.set_parent(other, row)
        elif action == "grow":
            locals_ = random_matrices(two, len(parents))
            tree.add_many(locals_, parents, row)
        elif action == "remove" and len(tree.subtree(row)) < len(tree):
            tree.remove(tree.subtree(row))
        elif action == "update":
            tree.update()
            check(tree)
    tree.update()
    check(tree)


@given(parent_lists(), st.integers(0, 29))
def test_an_edit_changes_the_subtree_and_nothing_else(
    parents: list[int], node: int
) -> None:
    tree = TransformTree()
    rows = tree.add_many(random_matrices(1, len(parents)), parents)
    tree.update()
    version = tree.version
    row = int(rows[node % len(rows)])
    tree.set_local(row, random_matrices(2, 1)[0])
    changed = tree.update()
    assert sorted(changed) == sorted(tree.subtree(row))
    assert tree.changed_since(version).tolist() == sorted(changed)
    assert tree.changed_since(tree.version).size == 0
    check(tree)


def test_nothing_touched_is_no_new_version() -> None:
    tree = TransformTree()
    tree.add_many(random_matrices(0, 5), [-1, 0, 1, 1, 0])
    tree.update()
    version = tree.version
    assert tree.update().size == 0
    assert tree.version == version


def test_several_edits_are_one_version() -> None:
    tree = TransformTree()
    rows = tree.add_many(random_matrices(0, 3), [-1, 0, 1])
    tree.update()
    version = tree.version
    tree.set_local(rows[[0, 2]], random_matrices(3, 2))
    assert sorted(tree.update()) == sorted(rows)
    assert tree.version == version + 1
    check(tree)


def test_freed_rows_are_used_again() -> None:
    tree = TransformTree()
    rows = tree.add_many(random_matrices(0, 4), [-1, 0, 1, 2])
    tree.remove(rows[2:])
    assert len(tree) == 2
    tree.add_many(random_matrices(1, 2), [-1, 0])
    assert len(tree) == 4
    assert len(tree.local) == 4
    tree.update()
    check(tree)


def test_children_of_removed_rows_stay_where_they_are() -> None:
    tree = TransformTree()
    model = tree.add(translation(1))
    camera = tree.add(translation(2), model)
    tree.remove(np.array([model]))
    tree.update()
    assert tree.parents[camera] == -1
    assert_allclose(tree.world[camera], translation(3))


def test_an_ancestor_cannot_be_a_child() -> None:
    tree = TransformTree()
    rows = tree.add_many(random_matrices(0, 3), [-1, 0, 1])
    with pytest.raises(OptionError, match="its own ancestor"):
        tree.set_parent(int(rows[0]), int(rows[2]))
    with pytest.raises(OptionError, match="its own ancestor"):
        tree.set_parent(int(rows[1]), int(rows[1]))


def test_parents_come_before_children() -> None:
    with pytest.raises(ValueError, match="before its children"):
        TransformTree().add_many(random_matrices(0, 2), [1, -1])


def test_absorbing_keeps_the_shape() -> None:
    tree, other = TransformTree(), TransformTree()
    tree.add_many(random_matrices(0, 3), [-1, 0, 0])
    rows = other.add_many(random_matrices(1, 4), [-1, 0, 1, 1])
    other.remove(rows[2:3])
    tree.absorb(other)
    tree.update()
    assert len(tree) == 6
    assert sorted(tree.parents) == [-1, -1, 0, 0, 3, 4]
    check(tree)


def test_rows_of_a_scene_cannot_be_absorbed() -> None:
    with pytest.raises(OptionError, match="another scene"):
        TransformTree().absorb(TransformTree(fixed=True))


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.eye(3), r"expected \(4, 4\) numbers, got \(3, 3\)"),
        (np.full((4, 4), np.nan), "NaN"),
        (np.eye(4)[::-1], "last row"),
        ([[1, 2], [3]], r"expected \(4, 4\) numbers"),
        ("nonsense", r"expected \(4, 4\) numbers"),
    ],
)
def test_what_is_not_affine_is_refused(matrix: object, message: str) -> None:
    tree = TransformTree()
    row = tree.add()
    with pytest.raises(OptionError, match=message):
        tree.set_local(row, matrix)  # type: ignore[arg-type]
    assert_allclose(tree.local[row], np.eye(4))


def test_overflow_is_no_warning() -> None:
    tree = TransformTree()
    huge = np.diag([1e200, 1e200, 1e200, 1])
    tree.add_many([huge, huge, huge], [-1, 0, 1])
    tree.update()
    assert np.isinf(tree.world[2, 0, 0])
