"""Draws merge where nothing but their instances differs, and only there."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from moka.backend.batching import MeshTable, merge_draws
from moka.commands.command_list import CommandList
from moka.commands.draws import DRAW, INSTANCE
from moka.commands.sort_key import SortKey

# Per mesh slot: source; meshes of one source can share a call.
SOURCES = (0, 0, 1)


def mesh_table(*, indexed: bool = True) -> MeshTable:
    """Three meshes; the first two share their buffers."""
    table = MeshTable()
    for slot, source in enumerate(SOURCES):
        table.put(
            slot,
            count=10 + slot,
            first=100 * slot,
            base_vertex=7 * slot,
            source=source,
            indexed=indexed,
        )
    return table


def record(columns: list[tuple[int, int, int, int]]) -> CommandList:
    """Draws of (program, bind group, state, mesh) in that order."""
    draws = np.zeros(len(columns), DRAW)
    for name, values in zip(
        ("program", "bind_group", "state", "mesh"),
        zip(*columns, strict=True),
        strict=True,
    ):
        draws[name] = values
    draws["first_instance"] = np.arange(len(columns))
    draws["instance_count"] = 1
    commands = CommandList()
    commands.draws(draws, np.zeros(len(columns), INSTANCE))
    return commands


def test_equal_draws_become_one_instanced_command() -> None:
    recording = record([(1, 1, 0, 0)] * 5).finish()
    batches = merge_draws(recording, mesh_table())
    assert batches.start == [0, 1]
    (command,) = batches.commands
    assert command["instance_count"] == 5
    assert command["count"] == 10


def test_meshes_of_one_source_share_a_batch() -> None:
    recording = record([(1, 1, 0, 0), (1, 1, 0, 1), (1, 1, 0, 2)]).finish()
    batches = merge_draws(recording, mesh_table())
    assert batches.start == [0, 2, 3]
    assert batches.source == [0, 1]
    assert batches.commands["base_instance"].tolist() == [0, 1, 2]
    assert batches.commands["base_vertex"].tolist() == [0, 7, 14]


def test_commands_without_indices_use_the_arrays_layout() -> None:
    recording = record([(1, 1, 0, 0), (1, 1, 0, 1)]).finish()
    batches = merge_draws(recording, mesh_table(indexed=False))
    # DrawArraysIndirectCommand: count, instances, first, base instance.
    assert batches.commands["first"].tolist() == [0, 107]
    assert batches.commands["base_vertex"].tolist() == [0, 1]


def test_a_command_between_draws_parts_them() -> None:
    commands = record([(1, 1, 0, 0)] * 2)
    commands.viewport(0, 0, 1, 1, key=SortKey(1))
    later = np.zeros(1, DRAW)
    later["key"] = int(SortKey(2))
    later["program"] = later["bind_group"] = 1
    later["instance_count"] = 1
    commands.draws(later, np.zeros(1, INSTANCE))
    batches = merge_draws(commands.finish(), mesh_table())
    assert batches.of_span == {0: range(1), 2: range(1, 2)}


def test_no_draws_make_no_batches() -> None:
    batches = merge_draws(CommandList().finish(), mesh_table())
    assert batches.of_span == {}


COLUMNS = st.tuples(
    st.integers(0, 2), st.integers(0, 1), st.integers(0, 1), st.integers(0, 2)
)


@given(st.lists(COLUMNS, min_size=1, max_size=40))
def test_expanding_the_batches_gives_the_draws_back(
    columns: list[tuple[int, int, int, int]],
) -> None:
    recording = record(columns).finish(sort=False)
    batches = merge_draws(recording, mesh_table())
    expanded = []
    for batch in range(len(batches.program)):
        for command in batches.commands[
            batches.start[batch] : batches.start[batch + 1]
        ]:
            mesh = int(command["count"]) - 10
            assert SOURCES[mesh] == batches.source[batch]
            first = int(command["base_instance"])
            assert first == len(expanded)
            expanded += [
                (
                    batches.program[batch],
                    batches.bind_group[batch],
                    batches.state[batch],
                    mesh,
                )
            ] * int(command["instance_count"])
    assert expanded == columns
