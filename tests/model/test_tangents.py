"""Tangents against a sequential MikkTSpace, and their guarantees."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.commands.descriptors import Topology
from moka.core.errors import ModelError
from moka.model import (
    Primitive,
    adjacency,
    quad,
    sphere,
    triangle_corners,
    with_flat_normals,
    with_tangents,
)
from moka.model.morphs import MorphTargets
from tests.model.mikktspace import corner_tangents

Array = np.ndarray[Any, Any]


def oracle(primitive: Primitive) -> list[Any]:
    def rows(name: str) -> list[tuple[float, ...]]:
        array = primitive.attributes[name].astype(np.float64)
        if name == "NORMAL":
            length = np.linalg.norm(array, axis=1, keepdims=True)
            array = array / np.where(length > 0, length, 1)
        return [tuple(row) for row in array.tolist()]

    return corner_tangents(
        rows("POSITION"),
        rows("NORMAL"),
        rows("TEXCOORD_0"),
        [tuple(row) for row in triangle_corners(primitive).tolist()],
    )


def check_against_oracle(primitive: Primitive) -> None:
    made = with_tangents(primitive)
    expected = oracle(primitive)
    order, new_order = triangle_corners(primitive), triangle_corners(made)
    # The geometry is the same, corner by corner.
    for name, array in primitive.attributes.items():
        np.testing.assert_array_equal(
            made.attributes[name][new_order], array[order]
        )
    tangents = made.attributes["TANGENT"][new_order].astype(np.float64)
    assert np.isfinite(tangents).all()
    np.testing.assert_allclose(
        np.linalg.norm(tangents[..., :3], axis=-1), 1, atol=1e-5
    )
    for found, wanted in zip(
        tangents.reshape(-1, 4),
        [corner for face in expected for corner in face],
        strict=True,
    ):
        if wanted is None:
            assert found[3] == 1
        elif np.linalg.norm(wanted[0]) > 1e-6:  # else they cancelled
            assert found[3] == wanted[1]
            np.testing.assert_allclose(found[:3], wanted[0], atol=2e-4)


def grid(columns: int, rows: int, uv: Array | None = None) -> Primitive:
    """A bent sheet with smooth normals and a sheared texture."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    x, y = x.reshape(-1), y.reshape(-1)
    z = 0.3 * np.sin(x) + 0.2 * np.cos(1.3 * y)
    normals = np.stack(
        [-0.3 * np.cos(x), 0.26 * np.sin(1.3 * y), np.ones_like(x)], -1
    )
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    first = np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)
    first = first.reshape(-1, 1)
    return Primitive(
        {
            "POSITION": np.stack([x, y, z], -1),
            "NORMAL": normals,
            "TEXCOORD_0": (
                np.stack([x + 0.3 * y, -y], -1) if uv is None else uv
            ),
        },
        (
            first + np.array([0, 1, columns + 1, 1, columns + 2, columns + 1])
        ).reshape(-1),
    )


def test_a_smooth_sheet_keeps_its_vertices() -> None:
    primitive = grid(4, 3)
    check_against_oracle(primitive)
    assert with_tangents(primitive).vertex_count == primitive.vertex_count


def test_the_tangent_runs_along_u() -> None:
    tangents = with_tangents(quad()).attributes["TANGENT"]
    assert tangents.tolist() == [[1, 0, 0, 1]] * 4


def test_a_mirrored_texture_splits_the_vertices_between() -> None:
    x = np.tile(np.arange(5.0), 3)
    uv = np.stack([np.abs(x - 2), -np.repeat(np.arange(3.0), 5)], -1)
    primitive = grid(4, 2, uv)
    made = with_tangents(primitive)
    # The three vertices of the middle column are needed twice.
    assert made.vertex_count == primitive.vertex_count + 3
    check_against_oracle(primitive)
    left = made.attributes["POSITION"][:, 0] < 2
    assert (made.attributes["TANGENT"][left, 3] == -1).all()
    right = made.attributes["POSITION"][:, 0] > 2
    assert (made.attributes["TANGENT"][right, 3] == 1).all()


def test_strips_become_lists() -> None:
    check_against_oracle(
        Primitive(
            {
                "POSITION": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0.5)],
                "NORMAL": [(0, 0, 1)] * 4,
                "TEXCOORD_0": [(0, 1), (1, 1), (0, 0), (1, 0)],
            },
            topology=Topology.TRIANGLE_STRIP,
        )
    )


def test_a_sphere_with_its_seam_and_poles() -> None:
    check_against_oracle(sphere(1, 8, 5))


def test_flat_normals_are_made_where_there_are_none() -> None:
    bare = Primitive(
        {
            "POSITION": [(0, 0, 0), (1, 0, 0), (0, 0, -1)],
            "TEXCOORD_1": [(0, 0), (1, 0), (0, -1)],
        }
    )
    made = with_tangents(bare, uv_set=1)
    assert made.attributes["NORMAL"].tolist() == [[0, 1, 0]] * 3
    assert made.attributes["TANGENT"].tolist() == [[1, 0, 0, 1]] * 3


def test_a_texture_without_direction_gives_unit_vectors_across() -> None:
    primitive = Primitive(
        {
            "POSITION": [(0, 0, 0), (0, 1, 0), (0, 0, 1)],
            "NORMAL": [(1, 0, 0)] * 3,
            "TEXCOORD_0": [(0.5, 0.5)] * 3,
        }
    )
    tangents = with_tangents(primitive).attributes["TANGENT"]
    np.testing.assert_allclose(tangents[:, 0], 0, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(tangents[:, :3], axis=1), 1)


def test_a_face_without_texture_joins_those_around_it() -> None:
    """The middle of three faces has one texture coordinate for all."""
    uv = [(0, 0), (1, 0), (0, -1), (0, -1), (0, 0)]
    primitive = Primitive(
        {
            "POSITION": [
                (0, 0, 0),
                (1, 0, 0.1),
                (0, 1, 0.2),
                (-1, 0, 0),
                (0, -1, 0),
            ],
            "NORMAL": [(0, 0, 1)] * 5,
            "TEXCOORD_0": uv,
        },
        [0, 1, 2, 0, 2, 3, 0, 3, 4],
    )
    check_against_oracle(primitive)


def test_coordinates_must_be_there() -> None:
    with pytest.raises(ModelError, match="tangents need TEXCOORD_1"):
        with_tangents(quad(), uv_set=1)


def test_points_stay_as_they_are() -> None:
    points = Primitive(
        {"POSITION": np.eye(3), "TEXCOORD_0": np.zeros((3, 2))},
        topology=Topology.POINTS,
    )
    assert with_tangents(points) is points


@st.composite
def soups(draw: st.DrawFn) -> Primitive:
    """Few points and many triangles: flat ones, edges of three, seams."""
    count = draw(st.integers(3, 7))
    # The points of a moment curve, no three on a line; some may coincide.
    places = draw(st.lists(st.integers(0, 6), min_size=count, max_size=count))
    curve = np.array([(t, t * t / 4, t**3 / 16) for t in places])
    uvs = draw(
        st.lists(
            st.tuples(st.integers(0, 3), st.integers(0, 3)),
            min_size=count,
            max_size=count,
        )
    )
    triangles = draw(
        st.lists(
            st.tuples(*[st.integers(0, count - 1)] * 3),
            min_size=1,
            max_size=9,
        )
    )
    return Primitive(
        {
            "POSITION": curve,
            "NORMAL": np.tile((0.6, 0.0, 0.8), (count, 1)),
            "TEXCOORD_0": np.array(uvs, "f4"),
        },
        np.reshape(triangles, -1),
    )


@settings(deadline=None, max_examples=500)
@given(soups())
def test_any_triangles_agree_with_the_oracle(primitive: Primitive) -> None:
    check_against_oracle(primitive)


def test_flat_shading_and_tangents_go_together() -> None:
    check_against_oracle(with_flat_normals(grid(3, 3)))


def test_vertices_keep_their_places() -> None:
    x = np.tile(np.arange(5.0), 3)
    uv = np.stack([np.abs(x - 2), -np.repeat(np.arange(3.0), 5)], -1)
    primitive = grid(4, 2, uv)
    made = with_tangents(primitive)
    assert made.vertex_count > primitive.vertex_count
    for name, array in primitive.attributes.items():
        np.testing.assert_array_equal(
            made.attributes[name][: primitive.vertex_count], array
        )


def test_what_no_triangle_names_stays_too() -> None:
    base = grid(2, 2)
    assert base.indices is not None
    primitive = Primitive(base.attributes, base.indices[:3])
    made = with_tangents(primitive)
    assert made.vertex_count == primitive.vertex_count
    lengths = np.linalg.norm(made.attributes["TANGENT"][:, :3], axis=1)
    np.testing.assert_allclose(lengths, 1, atol=1e-6)


def test_targets_go_with_their_vertices() -> None:
    x = np.tile(np.arange(5.0), 3)
    uv = np.stack([np.abs(x - 2), -np.repeat(np.arange(3.0), 5)], -1)
    base = grid(4, 2, uv)
    moved = np.arange(45, dtype=np.float32).reshape(15, 3)
    primitive = Primitive(
        base.attributes,
        base.indices,
        targets=MorphTargets([{"POSITION": moved}]),
    )
    made = with_tangents(primitive)
    assert made.targets is not None
    found = made.targets.deltas[0]["POSITION"]
    order, new_order = triangle_corners(primitive), triangle_corners(made)
    np.testing.assert_array_equal(found[new_order], moved[order])


def test_no_direction_is_zero_where_nothing_is_to_be_filled_in() -> None:
    primitive = Primitive(
        {
            "POSITION": [(0, 0, 0), (0, 1, 0), (0, 0, 1)],
            "NORMAL": [(1, 0, 0)] * 3,
            "TEXCOORD_0": [(0.5, 0.5)] * 3,
        }
    )
    tangents = with_tangents(primitive, fill=False).attributes["TANGENT"]
    assert tangents.tolist() == [[0, 0, 0, 1]] * 3


@pytest.mark.parametrize("multiplier", [None, 0])
def test_equal_rows_have_equal_numbers(
    monkeypatch: pytest.MonkeyPatch, multiplier: int | None
) -> None:
    if multiplier is not None:  # every code is that of all others
        monkeypatch.setattr(adjacency, "_MULTIPLIER", np.uint64(multiplier))
    random = np.random.default_rng(8)
    rows = random.integers(-1, 2, (300, 4)).astype(np.float32)
    rows *= random.choice([-1, 1], rows.shape)  # 0 becomes -0 as well
    numbers = adjacency.equal_rows(rows)
    _, expected = np.unique(rows + 0, axis=0, return_inverse=True)
    pairs = set(zip(numbers.tolist(), expected.tolist(), strict=True))
    assert len(pairs) == expected.max() + 1 == numbers.max() + 1
