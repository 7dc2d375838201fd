"""Batches, tiles and rectangles: when sampling stops."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from moka.renderer.convergence import (
    TILE,
    Convergence,
    Schedule,
    rectangles,
    tiles_of,
)


@given(st.integers(1, 100_000), st.booleans())
def test_a_schedule_has_the_samples_and_few_more(total, stops_early):
    schedule = Schedule.of(total, stops_early=stops_early)
    batch = schedule.samples * schedule.frames
    assert 0 <= schedule.batches * batch - total < batch
    assert schedule.samples <= 8
    assert not stops_early or batch <= 32
    assert schedule.total_frames == schedule.frames * schedule.batches
    # Enough batches to tell their spread, and frames for edges.
    assert schedule.batches >= min(total, 4)
    assert schedule.total_frames >= min(total, 12)


@given(
    arrays.arrays(
        bool, st.tuples(st.integers(1, 6), st.integers(1, 6)), fill=st.nothing()
    ),
    st.integers(1, TILE),
    st.integers(1, TILE),
)
def test_rectangles_cover_the_tiles_once(tiles, last_width, last_height):
    rows, columns = tiles.shape
    width = (columns - 1) * TILE + last_width
    height = (rows - 1) * TILE + last_height
    covered = np.zeros((height, width), int)
    for x, y, w, h in rectangles(tiles, (width, height)):
        assert w > 0
        assert h > 0
        assert x + w <= width
        assert y + h <= height
        covered[y : y + h, x : x + w] += 1
    expected = tiles.repeat(TILE, axis=0).repeat(TILE, axis=1)
    assert np.array_equal(covered, expected[:height, :width])


def test_whole_pictures_are_one_rectangle():
    assert rectangles(np.ones((3, 4), bool), (100, 70)) == [(0, 0, 100, 70)]


def report(errors: list[float], batches: float) -> np.ndarray:
    """One row of tiles, as tile_error.frag describes them."""
    texels = np.zeros((1, len(errors), 4), np.float32)
    texels[0, :, 0] = np.square(errors)
    texels[0, :, 1] = batches
    texels[0, :, 2] = TILE * TILE
    return texels


def test_one_batch_says_nothing_of_the_error():
    convergence = Convergence((1, 2), 0.1, 100)
    convergence.update(report([0.0, 0.0], 1))
    assert convergence.error is None
    assert convergence.active.all()
    assert convergence.mean_batches == 1


def test_few_batches_tell_an_error_that_stops_nothing():
    convergence = Convergence((1, 2), 0.1, 100)
    convergence.update(report([0.01, 0.02], 3))
    assert convergence.error == pytest.approx(0.02)
    assert convergence.active.all()


def test_converged_tiles_stay_so():
    convergence = Convergence((1, 3), 0.1, 100)
    convergence.update(report([0.05, 0.2, 0.15], 4))
    assert convergence.active.tolist() == [[False, True, True]]
    convergence.update(report([0.12, 0.09, 0.14], 5))
    assert convergence.active.tolist() == [[False, False, True]]
    assert not convergence.is_reached
    convergence.update(report([0.12, 0.09, 0.1], 6))
    assert convergence.is_reached
    assert convergence.error == pytest.approx(0.12)


def test_an_error_that_is_no_number_is_not_small():
    convergence = Convergence((1, 2), 0.1, 100)
    convergence.update(report([np.nan, 0.05], 8))
    assert convergence.active.tolist() == [[True, False]]


def test_without_an_aim_everything_is_sampled_on():
    convergence = Convergence((1, 2), None, 100)
    convergence.update(report([0.0, 0.0], 100))
    assert convergence.active.all()


def test_a_tile_gets_its_batches_and_no_more():
    convergence = Convergence((1, 2), None, 2)
    convergence.end_batch()
    assert convergence.active.all()
    convergence.end_batch()
    assert convergence.is_reached


def test_tiles_that_come_into_view_get_as_many():
    convergence = Convergence((1, 3), None, 2)
    assert not convergence.see(np.array([[True, True, False]]))
    convergence.end_batch()
    # Fewer do not begin anything anew.
    assert not convergence.see(np.array([[True, False, False]]))
    convergence.end_batch()
    assert convergence.is_reached
    assert convergence.see(np.array([[True, True, True]]))
    assert convergence.active.tolist() == [[False, True, True]]
    convergence.end_batch()
    assert convergence.active.tolist() == [[False, False, True]]
    convergence.end_batch()
    # Those that have their batches are not begun again.
    assert not convergence.see(np.array([[True, False, False]]))
    assert not convergence.see(np.array([[True, True, True]]))
    assert convergence.is_reached


def test_errors_are_those_of_what_is_seen():
    convergence = Convergence((1, 2), 0.1, 100)
    convergence.see(np.array([[True, False]]))
    texels = report([0.05, 9.0], 4)
    texels[0, 1, 1] = 0
    convergence.update(texels)
    assert convergence.error == pytest.approx(0.05)
    assert convergence.mean_batches == 4
    assert convergence.is_reached
    convergence.see(np.zeros((1, 2), bool))
    convergence.update(texels)
    assert convergence.error == pytest.approx(0.05)


@given(
    st.tuples(st.integers(1, 100), st.integers(1, 100)),
    st.tuples(*[st.integers(0, 100)] * 4),
)
def test_tiles_of_an_area_are_those_that_it_overlaps(size, area):
    x, y = min(area[0], size[0] - 1), min(area[1], size[1] - 1)
    area = (x, y, min(area[2], size[0] - x), min(area[3], size[1] - y))
    covered = np.zeros((size[1], size[0]), bool)
    covered[y : y + area[3], x : x + area[2]] = True
    tiles = tiles_of(area, size)
    for (row, column), is_seen in np.ndenumerate(tiles):
        part = covered[TILE * row :, TILE * column :][:TILE, :TILE]
        assert part.any() <= is_seen
        if area[2] and area[3]:
            assert part.any() == is_seen
    assert tiles_of(None, size).all()
    assert tiles_of(None, size).shape == tiles.shape
