"""Merges sorted draws: the fewest GL calls that draw the same picture.

Neighbours that differ only by their instances become one instanced command;
commands that share program, bind group, raster state and vertex source
become one batch, which is one multi-draw-indirect call where the driver has
it. All of it on whole arrays: the cost in Python is per batch, not per draw.
"""

from collections.abc import Iterable

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.recording import DrawSpan, Recording

__all__ = ["INDIRECT", "Batches", "MeshTable", "merge_draws"]

# DrawElementsIndirectCommand; commands without indices use the same stride
# with DrawArraysIndirectCommand's field order (base instance comes fourth).
INDIRECT = np.dtype(
    [
        ("count", np.uint32),
        ("instance_count", np.uint32),
        ("first", np.uint32),
        ("base_vertex", np.int32),
        ("base_instance", np.uint32),
    ]
)

_MESH = np.dtype(
    [
        ("count", np.uint32),
        ("first", np.uint32),
        ("base_vertex", np.int32),
        ("source", np.int32),
        ("indexed", np.bool_),
    ]
)


class MeshTable:
    """The meshes of a backend as rows, indexed by their handles' slots.

    ``source`` numbers what must be bound to draw a mesh: buffers, layout,
    topology; meshes of equal source can share one GL call.
    """

    def __init__(self) -> None:
        self.rows = np.zeros(64, _MESH)

    def put(
        self,
        index: int,
        *,
        count: int,
        first: int,
        base_vertex: int,
        source: int,
        indexed: bool,
    ) -> None:
        """Set row ``index``."""
        while index >= len(self.rows):
            self.rows = np.concatenate([self.rows, np.zeros_like(self.rows)])
        self.rows[index] = (count, first, base_vertex, source, indexed)


class Batches(Struct, frozen=True):
    """Indirect commands of a frame and how they group into batches.

    Batch ``i`` is ``commands[start[i]:start[i + 1]]``; ``program``,
    ``bind_group``, ``state`` and ``source`` are what it binds. ``of_span``
    maps the start of a draw span to its range of batches.
    """

    commands: NDArray[np.void]
    start: list[int]
    program: list[int]
    bind_group: list[int]
    state: list[int]
    source: list[int]
    of_span: dict[int, range]


def merge_draws(recording: Recording, meshes: MeshTable) -> Batches:
    """Group the draws of ``recording`` without changing their order."""
    draws = recording.draws
    spans = [step for step in recording.steps if isinstance(step, DrawSpan)]
    if not len(draws):
        return Batches(np.zeros(0, INDIRECT), [0], [], [], [], [], {})
    # Words of two columns each: program and bind group, mesh and state.
    words = np.ascontiguousarray(draws).view(np.uint64).reshape(len(draws), -1)
    begins_span = np.zeros(len(draws), np.bool_)
    begins_span[[span.start for span in spans]] = True
    new_command = begins_span.copy()
    for word in (1, 2):
        new_command[1:] |= words[1:, word] != words[:-1, word]
    first_draws = np.flatnonzero(new_command)

    head = draws[first_draws]
    mesh = meshes.rows[head["mesh"]]
    new_batch = begins_span[first_draws]
    for column in (
        head["program"],
        head["bind_group"],
        head["state"],
        mesh["source"],
    ):
        new_batch[1:] |= column[1:] != column[:-1]
    commands = _commands(draws, mesh, first_draws)
    batches = np.flatnonzero(new_batch)
    heads = first_draws[batches]
    start = [*batches.tolist(), len(commands)]
    return Batches(
        commands,
        start,
        draws["program"][heads].tolist(),
        draws["bind_group"][heads].tolist(),
        draws["state"][heads].tolist(),
        mesh["source"][batches].tolist(),
        _batches_of_spans(spans, heads),
    )


def _commands(
    draws: NDArray[np.void],
    heads: NDArray[np.void],
    first_draws: NDArray[np.int64],
) -> NDArray[np.void]:
    """The indirect commands; ``heads`` are the meshes of ``first_draws``."""
    commands = np.empty(len(first_draws), INDIRECT)
    commands["count"] = heads["count"]
    commands["first"] = heads["first"]
    commands["instance_count"] = np.add.reduceat(
        draws["instance_count"], first_draws
    )
    base_instance = draws["first_instance"][first_draws]
    commands["base_vertex"] = heads["base_vertex"]
    commands["base_instance"] = base_instance
    arrays = ~heads["indexed"]
    if arrays.any():
        # Without indices there is no base vertex: its field is the fourth
        # word's place, where DrawArraysIndirectCommand has baseInstance.
        commands["first"][arrays] += heads["base_vertex"][arrays].astype("u4")
        commands["base_vertex"][arrays] = base_instance[arrays]
    return commands


def _batches_of_spans(
    spans: Iterable[DrawSpan], heads: NDArray[np.int64]
) -> dict[int, range]:
    bounds = np.searchsorted(
        heads, [(span.start, span.stop) for span in spans]
    ).tolist()
    return {
        span.start: range(first, last)
        for span, (first, last) in zip(spans, bounds, strict=True)
    }
