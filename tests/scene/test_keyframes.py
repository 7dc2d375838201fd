"""Keyframes sampled all at once, against one at a time in float64."""

import gc
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.model.animation import (
    PROPERTIES,
    AnimationChannel,
    AnimationTarget,
    Interpolation,
)
from moka.scene.keyframes import KeyframeSampler
from tests.support.oracles.keyframes import sample

MODES = ("STEP", "LINEAR", "CUBICSPLINE")


def channel(
    name: str,
    index: int,
    times: Sequence[float] | np.ndarray[Any, Any],
    values: Any,
    interpolation: str = "LINEAR",
) -> AnimationChannel:
    return AnimationChannel(
        AnimationTarget("node", index, name),
        Interpolation(interpolation),
        np.asarray(times, np.float32),
        np.asarray(values, np.float32),
    )


def sampled(channels: list[AnimationChannel], time: float) -> list[Any]:
    """The value of each channel; weights get places of their own."""
    places, ends = [], {}
    for each in channels:
        name = each.target.property
        width = each.values.shape[-1] if name == "weights" else 1
        start = ends.get(name, 0)
        ends[name] = start + width
        places.append(np.arange(start, start + width))
    columns: dict[str, dict[int, Any]] = {}
    sampler = KeyframeSampler(channels, places)
    # Two others beside it, which must not matter.
    times = np.array([0.7, time, 0.0])
    for (_, name), rows, values in sampler.sample(times):
        assert values.dtype == np.float64
        column = columns.setdefault(name, {})
        column.update(zip(rows.tolist(), values[1], strict=True))
    return [
        np.concatenate(
            [columns[each.target.property][place] for place in where.tolist()]
        )
        for each, where in zip(channels, places, strict=True)
    ]


def expected(each: AnimationChannel, time: float) -> Any:
    return sample(
        each.times.tolist(),
        each.values,
        each.interpolation.value,
        time,
        rotates=each.target.property == "rotation",
    )


def random_channels(
    random: np.random.Generator, count: int
) -> list[AnimationChannel]:
    """Channels of all kinds; some share their times."""
    shared = np.sort(random.uniform(0, 5, 7)).astype(np.float32)
    made = []
    for index in range(count):
        name = ("translation", "rotation", "scale", "weights")[index % 4]
        mode = MODES[int(random.integers(3))]
        times = shared
        if random.random() < 0.5:
            keys = int(random.integers(2, 9))
            times = np.sort(random.uniform(0, 5, keys)).astype(np.float32)
        width = PROPERTIES["node", name] or int(random.integers(1, 4))
        shape = (len(times), width)
        if mode == "CUBICSPLINE":
            shape = (len(times), 3, width)
        made.append(
            channel(name, index, times, random.normal(size=shape), mode)
        )
    return made


@pytest.mark.parametrize("seed", range(4))
def test_all_channels_agree_with_the_oracle(seed: int) -> None:
    random = np.random.default_rng(seed)
    channels = random_channels(random, 60)
    keys = [float(time) for each in channels for time in each.times[:2]]
    for time in [-1.0, 0.0, 5.0, 9.0, *random.uniform(0, 5, 12), *keys[:6]]:
        for got, each in zip(sampled(channels, time), channels, strict=True):
            np.testing.assert_allclose(
                got, expected(each, time), rtol=0, atol=1e-12
            )


finite = st.floats(-1e6, 1e6, width=32)
quaternions = st.tuples(finite, finite, finite, finite).filter(
    lambda q: np.linalg.norm(q) > 1e-3
)


@given(
    first=quaternions,
    second=quaternions,
    fraction=st.floats(0, 1),
)
def test_rotations_take_the_shorter_way_and_stay_unit(
    first: tuple[float, ...], second: tuple[float, ...], fraction: float
) -> None:
    each = channel("rotation", 0, [0, 1], [first, second])
    (got,) = sampled([each], fraction)
    want = expected(each, fraction)
    assert abs(np.linalg.norm(got) - 1) < 1e-14
    # The same rotation; at half a turn both ways are the shorter one.
    a, b = np.float32(first), np.float32(second)
    a, b = (q / np.linalg.norm(q.astype(np.float64)) for q in (a, b))
    if abs(a @ b) > 1e-9:
        assert abs(abs(got @ want) - 1) < 1e-12
        whole = np.arccos(min(abs(a @ b), 1.0))
        part = np.arccos(min(abs(a @ got), 1.0))
        assert abs(part - fraction * whole) < 1e-7


@given(
    times=st.lists(
        st.floats(0, 1e6, width=32), min_size=1, max_size=6, unique=True
    ),
    time=st.floats(-10, 2e6),
    mode=st.sampled_from(MODES),
    seed=st.integers(0, 99),
)
def test_any_times_agree_with_the_oracle(
    times: list[float], time: float, mode: str, seed: int
) -> None:
    random = np.random.default_rng(seed)
    times = sorted(np.abs(times).tolist())
    if mode == "CUBICSPLINE":
        times = [*times, times[-1] + 1]
    shape = (len(times), 3, 3) if mode == "CUBICSPLINE" else (len(times), 3)
    # A neighbour with other times must not be looked into.
    each = channel("scale", 0, times, random.normal(size=shape), mode)
    other = channel("scale", 1, [0.25, 1e30], np.ones((2, 3)))
    for moment in (time, times[0], times[-1]):
        got = sampled([other, each, other], moment)[1]
        span = max(times[-1] - times[0], 1)
        np.testing.assert_allclose(
            got, expected(each, moment), rtol=0, atol=1e-10 * span
        )


def test_a_keyframe_is_met_exactly_at_its_time() -> None:
    times = np.float32([0, 0.1, 0.3, 1 / 3])
    values = np.random.default_rng(0).normal(size=(4, 3)).astype(np.float32)
    for mode in ("STEP", "LINEAR"):
        each = channel("translation", 0, times, values, mode)
        for key, time in enumerate(times.tolist()):
            (got,) = sampled([each], time)
            np.testing.assert_array_equal(got, values[key])


def test_a_step_holds_until_just_before_the_next_key() -> None:
    each = channel("translation", 0, [0, 0.1], np.eye(3)[:2], "STEP")
    key = float(np.float32(0.1))
    (got,) = sampled([each], np.nextafter(key, 0))
    np.testing.assert_array_equal(got, (1, 0, 0))
    (got,) = sampled([each], key)
    np.testing.assert_array_equal(got, (0, 1, 0))


def test_tangents_are_per_second() -> None:
    # A line of slope 2 as a spline: value 2 t at every time.
    values = [[[2], [0], [2]], [[2], [8], [2]]]
    each = channel("weights", 0, [0, 4], values, "CUBICSPLINE")
    for time in (0.5, 1.0, 3.25):
        (got,) = sampled([each], time)
        np.testing.assert_allclose(got, [2 * time], rtol=1e-15)


def test_no_channel_costs_a_call_of_its_own() -> None:
    """Python's work is the same for ten thousand channels as for a few."""

    def calls(count: int) -> int:
        channels = random_channels(np.random.default_rng(1), count)
        widths = [
            each.values.shape[-1] if each.target.property == "weights" else 1
            for each in channels
        ]
        ends = np.cumsum(widths)
        places = [
            np.arange(end - width, end)
            for width, end in zip(widths, ends.tolist(), strict=True)
        ]
        sampler = KeyframeSampler(channels, places)
        times = np.array([2.5])
        seen: list[object] = []
        gc.disable()  # Its callbacks are calls too, at any time.
        sys.setprofile(lambda *event: seen.append(event))
        try:
            list(sampler.sample(times))
        finally:
            sys.setprofile(None)
            gc.enable()
        return len(seen)

    assert calls(10_000) == calls(3_000)
