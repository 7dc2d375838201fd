"""Segments of lines against the definitions of the specification."""

import numpy as np
import pytest

from moka.commands.descriptors import Topology
from moka.model.lines import line_segments
from moka.model.mesh import Primitive


@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("indexed", [False, True])
def test_segments(count: int, indexed: bool) -> None:
    order = np.random.default_rng(count).permutation(count)
    taken = order.tolist() if indexed else list(range(count))
    expected = {
        Topology.LINES: [
            (taken[2 * i], taken[2 * i + 1]) for i in range(count // 2)
        ],
        Topology.LINE_STRIP: [
            (taken[i], taken[i + 1]) for i in range(count - 1)
        ],
        Topology.LINE_LOOP: [
            (taken[i], taken[(i + 1) % count])
            for i in range(count)
            if count > 1
        ],
        Topology.POINTS: [],
        Topology.TRIANGLES: [],
    }
    for topology, pairs in expected.items():
        primitive = Primitive(
            {"POSITION": np.zeros((count, 3))},
            order if indexed else None,
            topology=topology,
        )
        segments = line_segments(primitive)
        assert segments.shape == (len(pairs), 2)
        assert list(map(tuple, segments.tolist())) == pairs
        if topology not in (Topology.POINTS, Topology.TRIANGLES):
            assert primitive.element_count == len(pairs)
