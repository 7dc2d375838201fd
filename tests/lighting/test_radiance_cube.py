"""Which faces of a cube a sun in a map touches."""

import numpy as np
import pytest

from moka.lighting.equirectangular import direction_to_uv
from moka.lighting.radiance_cube import faces_that_differ

SHAPE = (64, 128, 3)


def changed_at(*directions: tuple[float, float, float]) -> np.ndarray:
    changed = np.zeros(SHAPE, np.float32)
    for direction in directions:
        u, v = direction_to_uv(direction)
        row = min(int(v * SHAPE[0]), SHAPE[0] - 1)
        changed[row, int(u * SHAPE[1]) % SHAPE[1]] = 1.0
    return changed


@pytest.mark.parametrize("face", range(6))
def test_a_texel_in_the_middle_of_a_face_touches_it_alone(face: int) -> None:
    # Away from the poles, where a row is all around.
    direction = np.full(3, 0.3)
    direction[face // 2] = -1.0 if face % 2 else 1.0
    found = faces_that_differ(np.zeros(SHAPE), changed_at(tuple(direction)))
    assert found == {face}


def test_a_texel_at_an_edge_touches_both_sides() -> None:
    found = faces_that_differ(np.zeros(SHAPE), changed_at((1.0, 0.1, 1.0)))
    assert found == {0, 4}


def test_the_seam_is_no_edge_and_equal_maps_touch_nothing() -> None:
    found = faces_that_differ(np.zeros(SHAPE), changed_at((-1.0, 0.0, 0.0)))
    assert found == {1}
    assert faces_that_differ(np.ones(SHAPE), np.ones(SHAPE)) == frozenset()
