"""Fewer samples while things move."""

import pytest

from moka.renderer.settings import RenderSettings
from moka.ui import draft as draft_module
from moka.ui.draft import Draft

FULL = RenderSettings(samples=4, exposure=1.0)


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(draft_module, "time", clock)
    return clock


def test_a_slow_picture_has_one_sample_until_it_rests(clock: Clock) -> None:
    draft = Draft()
    assert draft.settings(FULL) == FULL
    draft.note_wait(0.2)
    assert draft.settings(FULL) == FULL  # Nothing moves.
    draft.note_motion()
    assert draft.settings(FULL) == RenderSettings(samples=1, exposure=1.0)
    draft.note_wait(0.01)  # That of a draft says nothing of a whole one.
    clock.now += 0.1
    draft.note_motion()
    clock.now += 0.1
    assert draft.settings(FULL).samples == 1
    clock.now += 0.2
    assert not draft.is_moving
    assert draft.settings(FULL) == FULL


def test_a_fast_picture_is_always_whole(clock: Clock) -> None:
    draft = Draft()
    for _ in range(10):
        draft.note_motion()
        draft.note_wait(0.02)
        assert draft.settings(FULL) == FULL
        clock.now += 0.02


@pytest.mark.parametrize(
    "settings",
    [RenderSettings(samples=1), RenderSettings(ibl="reference")],
)
def test_what_has_no_samples_of_edges_stays(
    clock: Clock,  # noqa: ARG001
    settings: RenderSettings,
) -> None:
    draft = Draft()
    draft.note_wait(1.0)
    draft.note_motion()
    assert draft.settings(settings) == settings


def test_a_person_may_not_want_it(clock: Clock) -> None:  # noqa: ARG001
    draft = Draft()
    draft.is_wanted = False
    draft.note_wait(1.0)
    draft.note_motion()
    assert draft.settings(FULL) == FULL
