"""Time as an app is told it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.app.clock import LONGEST_DELTA, Clock

durations = st.lists(st.floats(0.0, 0.2), min_size=1, max_size=50)


def test_one_update_a_frame_by_default() -> None:
    clock = Clock()
    seen = []
    for elapsed in (0.0, 0.5, 0.125):
        seen += clock.advance(elapsed)
        assert clock.frame(elapsed).total == seen[-1].total
    assert [time.frame for time in seen] == [0, 1, 2]
    # A stall counts as a quarter of a second and not more.
    assert [time.delta for time in seen] == [0.0, LONGEST_DELTA, 0.125]
    assert [time.total for time in seen] == [0.0, 0.25, 0.375]


@given(durations, st.floats(0.001, 0.1))
def test_fixed_steps_keep_up_with_time(
    elapsed: list[float], step: float
) -> None:
    clock = Clock()
    seen = []
    passed = 0.0
    for duration in elapsed:
        seen += clock.advance(duration, fixed_step=step)
        passed += duration
    assert all(time.delta == step for time in seen)
    assert [time.frame for time in seen] == list(range(len(seen)))
    # The first frame has an update even if no time has passed.
    assert passed - len(seen) * step + step >= -1e-6
    assert passed - len(seen) * step < step + 1e-6


def test_time_stands_still_in_a_pause() -> None:
    clock = Clock()
    list(clock.advance(0.0))
    assert list(clock.advance(0.1, paused=True)) == []
    assert clock.frame(0.1, paused=True).delta == 0.0
    (time,) = clock.advance(0.1)
    assert time.total == pytest.approx(0.1)


def test_a_pause_owes_no_steps() -> None:
    clock = Clock()
    list(clock.advance(0.0, fixed_step=0.1))
    for _ in range(10):
        assert list(clock.advance(0.2, fixed_step=0.1, paused=True)) == []
    assert len(list(clock.advance(0.1, fixed_step=0.1))) == 1
