"""What is recorded comes out in key order, and whole."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.commands.command_list import CommandList
from moka.commands.commands import Clear, SetScissor, SetViewport
from moka.commands.descriptors import CullMode, RasterState
from moka.commands.draws import DRAW, INSTANCE
from moka.commands.handles import Handle, ResourceKind
from moka.commands.recording import DrawSpan, Recording
from moka.commands.sort_key import SortKey, Stage
from moka.core.errors import CommandError

PROGRAM = Handle(ResourceKind.PROGRAM, 1, 0, 0)
MESH = Handle(ResourceKind.MESH, 2, 0, 0)
GROUP = Handle(ResourceKind.BIND_GROUP, 3, 0, 0)


def rows(keys: list[int]) -> np.ndarray:
    """Draw rows that tell their number by mesh and first instance."""
    draws = np.zeros(len(keys), DRAW)
    draws["key"] = keys
    draws["mesh"] = np.arange(len(keys))
    draws["first_instance"] = np.arange(len(keys))
    draws["instance_count"] = 1
    return draws


def instances(count: int, first: int = 0) -> np.ndarray:
    """Instances that tell their number by their object."""
    array = np.zeros(count, INSTANCE)
    array["object"] = np.arange(first, first + count)
    return array


def test_entries_without_a_key_stay_in_recorded_order() -> None:
    commands = CommandList()
    commands.clear((0, 0, 0, 1))
    commands.viewport(0, 0, 8, 8)
    commands.draw(PROGRAM, MESH, GROUP)
    commands.scissor(None)
    recording = commands.finish()
    assert [type(step) for step in recording.steps] == [
        Clear,
        SetViewport,
        DrawSpan,
        SetScissor,
    ]


def test_keys_decide_and_ties_keep_their_order() -> None:
    commands = CommandList()
    commands.viewport(2, 0, 1, 1, key=SortKey(2))
    commands.viewport(0, 0, 1, 1, key=SortKey(1))
    commands.viewport(1, 0, 1, 1, key=SortKey(1))
    order = [step.rectangle[0] for step in commands.finish().steps]
    assert order == [0, 1, 2]
    unsorted = [step.rectangle[0] for step in commands.finish(sort=False).steps]
    assert unsorted == [2, 0, 1]


def test_a_buffer_keeps_its_commands_together() -> None:
    commands = CommandList()
    buffer = commands.command_buffer(SortKey(3))
    commands.clear(depth=1.0, key=SortKey(1))
    buffer.viewport(0, 0, 4, 4)
    buffer.draw(PROGRAM, MESH, GROUP)
    buffer.viewport(0, 0, 8, 8)
    steps = commands.finish().steps
    assert isinstance(steps[0], Clear)
    assert steps[1] == SetViewport((0, 0, 4, 4))
    assert isinstance(steps[2], DrawSpan)
    assert steps[3] == SetViewport((0, 0, 8, 8))


def test_bulk_draws_are_cut_where_a_command_stands_between() -> None:
    key = [int(SortKey(p, stage=Stage.OPAQUE)) for p in (1, 1, 3, 3)]
    commands = CommandList()
    commands.draws(rows(key), instances(4))
    commands.viewport(0, 0, 1, 1, key=SortKey(2))
    steps = commands.finish().steps
    assert steps[0] == DrawSpan(0, 2)
    assert isinstance(steps[1], SetViewport)
    assert steps[2] == DrawSpan(2, 4)


@given(st.lists(st.integers(0, 5), min_size=1, max_size=40), st.booleans())
def test_bulk_draws_sort_stably_and_take_their_instances_along(
    keys: list[int], by_hand: bool
) -> None:
    commands = CommandList()
    if by_hand:
        commands.draw(PROGRAM, MESH, GROUP, instances=instances(3, 900))
    commands.draws(rows(keys), instances(len(keys)))
    recording = commands.finish()
    skip = 1 if by_hand else 0
    expected = sorted(range(len(keys)), key=lambda i: (keys[i], i))
    drawn = recording.draws[skip:]
    assert drawn["mesh"].tolist() == expected
    first = drawn["first_instance"]
    assert recording.instances["object"][first].tolist() == expected
    counts = recording.draws["instance_count"]
    starts = recording.draws["first_instance"]
    assert np.array_equal(starts, np.cumsum(counts) - counts)


def test_draws_with_many_instances_keep_them_in_order() -> None:
    draws = rows([1, 0])
    draws["first_instance"] = [0, 2]
    draws["instance_count"] = [2, 3]
    commands = CommandList()
    commands.draws(draws, instances(5))
    recording = commands.finish()
    assert recording.instances["object"].tolist() == [2, 3, 4, 0, 1]
    assert recording.draws["first_instance"].tolist() == [0, 3]
    # The caller's rows are not touched.
    assert draws["first_instance"].tolist() == [0, 2]


@given(
    st.lists(st.integers(0, 3), max_size=8),
    st.lists(st.tuples(st.integers(0, 3), st.booleans()), max_size=5),
    st.lists(st.integers(0, 2), min_size=8, max_size=8),
)
def test_draws_that_are_in_order_end_up_as_sorted_ones_would(
    keys: list[int], buffers: list[tuple[int, bool]], counts: list[int]
) -> None:
    """With buffers before, between and behind them, recorded at any time."""
    recorded = []
    for in_order in (False, True):
        commands = CommandList()

        def record(early: bool, commands: CommandList = commands) -> None:
            for number, (key, is_early) in enumerate(buffers):
                if is_early == early:
                    buffer = commands.command_buffer(key)
                    buffer.viewport(number, 0, 1, 1)
                    buffer.draw(PROGRAM, MESH, GROUP)

        record(early=True)
        draws = rows(sorted(keys))
        draws["instance_count"] = counts[: len(keys)]
        ends = np.cumsum(draws["instance_count"])
        draws["first_instance"] = ends - draws["instance_count"]
        commands.draws(draws, instances(int(sum(counts)), 1), in_order=in_order)
        record(early=False)
        recorded.append(commands.finish())
    plain, ready = recorded
    assert [type(step) for step in plain.steps] == [
        type(step) for step in ready.steps
    ]
    assert _flat(plain) == _flat(ready)
    assert plain.draws.tolist() == ready.draws.tolist()
    assert plain.instances.tobytes() == ready.instances.tobytes()


def _flat(recording: Recording) -> list[object]:
    """The steps, spans as the draws in them."""
    flat: list[object] = []
    for step in recording.steps:
        if isinstance(step, DrawSpan):
            flat += recording.draws[step.start : step.stop].tolist()
        else:
            flat.append(step)
    return flat


def test_recorded_bytes_are_copied() -> None:
    buffer = Handle(ResourceKind.BUFFER, 0, 0, 0)
    data = np.zeros(4, np.uint8)
    commands = CommandList()
    commands.fill_buffer(buffer, data)
    data[:] = 7
    assert commands.finish().steps[0].data == bytes(4)


def test_states_are_shared_and_handles_are_collected() -> None:
    commands = CommandList()
    state = RasterState(cull=CullMode.NONE)
    commands.draw(PROGRAM, MESH, GROUP, state)
    commands.draw(PROGRAM, MESH, GROUP, RasterState(cull=CullMode.NONE))
    recording = commands.finish()
    assert recording.states == (state,)
    assert recording.handles[0] == {PROGRAM, MESH, GROUP}


def test_misuse_is_refused() -> None:
    commands = CommandList()
    with pytest.raises(CommandError, match="expected a program handle"):
        commands.draw(MESH, MESH, GROUP)
    with pytest.raises(CommandError, match="64 bits"):
        commands.command_buffer(1 << 64)
    with pytest.raises(CommandError, match="instances that are not there"):
        commands.draws(rows([0, 1]), instances(1))
    with pytest.raises(CommandError, match="dtypes"):
        commands.draws(np.zeros(1, np.uint64), instances(1))


def test_an_empty_list_is_an_empty_recording() -> None:
    commands = CommandList()
    assert commands.is_empty
    recording = commands.finish()
    assert recording.steps == ()
    assert len(recording.draws) == 0
