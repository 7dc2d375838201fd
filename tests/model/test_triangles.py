"""Triangles of every topology, and flat normals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moka.commands.descriptors import Topology
from moka.model import Primitive, triangle_corners, with_flat_normals


def expected_triangles(topology: Topology, order: list[int]) -> list[list[int]]:
    """As section 3.7.2.1 of the specification writes them."""
    if topology is Topology.TRIANGLES:
        return [order[3 * i : 3 * i + 3] for i in range(len(order) // 3)]
    if topology is Topology.TRIANGLE_STRIP:
        return [
            [order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]]
            for i in range(len(order) - 2)
        ]
    return [
        [order[i + 1], order[i + 2], order[0]] for i in range(len(order) - 2)
    ]


@settings(deadline=None)
@given(
    topology=st.sampled_from(
        [
            Topology.TRIANGLES,
            Topology.TRIANGLE_STRIP,
            Topology.TRIANGLE_FAN,
        ]
    ),
    order=st.lists(st.integers(0, 9), min_size=1, max_size=12),
    indexed=st.booleans(),
)
def test_triangles_are_those_of_the_specification(
    topology: Topology, order: list[int], indexed: bool
) -> None:
    if indexed:
        primitive = Primitive(
            {"POSITION": np.zeros((10, 3))}, order, topology=topology
        )
    else:
        order = list(range(len(order)))
        primitive = Primitive(
            {"POSITION": np.zeros((len(order), 3))}, topology=topology
        )
    corners = triangle_corners(primitive)
    assert corners.shape[1:] == (3,)
    assert corners.tolist() == expected_triangles(topology, order)
    assert len(corners) == primitive.element_count


@pytest.mark.parametrize(
    "topology",
    [
        Topology.POINTS,
        Topology.LINES,
        Topology.LINE_LOOP,
        Topology.LINE_STRIP,
    ],
)
def test_points_and_lines_have_no_triangles(topology: Topology) -> None:
    primitive = Primitive({"POSITION": np.eye(3)}, topology=topology)
    assert triangle_corners(primitive).shape == (0, 3)
    assert with_flat_normals(primitive) is primitive


@pytest.mark.parametrize(
    "topology", [Topology.TRIANGLE_STRIP, Topology.TRIANGLE_FAN]
)
def test_flat_normals_of_strips_and_fans_face_one_way(
    topology: Topology,
) -> None:
    strip = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
    fan = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    flat = with_flat_normals(
        Primitive(
            {
                "POSITION": strip if topology.value.endswith("p") else fan,
                "TEXCOORD_0": [(0, 0), (1, 0), (0, 1), (1, 1)],
                "TANGENT": np.ones((4, 4)),
            },
            topology=topology,
        )
    )
    assert flat.topology is Topology.TRIANGLES
    assert flat.indices is None
    assert set(flat.attributes) == {"POSITION", "NORMAL", "TEXCOORD_0"}
    assert flat.attributes["NORMAL"].tolist() == [[0, 0, 1]] * 6


def test_flat_normals_separate_triangles_and_survive_small_ones() -> None:
    positions = 1e-20 * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    primitive = Primitive({"POSITION": positions}, [0, 1, 2, 0, 2, 3, 0, 0, 1])
    flat = with_flat_normals(primitive)
    assert flat.attributes["NORMAL"][::3].tolist() == [
        [0, 0, 1],
        [1, 0, 0],
        [0, 0, 1],  # no area, and so no direction of its own
    ]
    assert np.array_equal(
        flat.attributes["POSITION"],
        primitive.attributes["POSITION"][[0, 1, 2, 0, 2, 3, 0, 0, 1]],
    )
