"""Records a frame on any thread; sorts it; knows nothing of GL.

Two kinds of entries share one order: command buffers (a key and a run of
rare commands and hand-recorded draws that stay together) and bulk draws (a
row each, every row with a key of its own). Every packet carries all that it
needs, so nothing set for one draw reaches the next.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_buffer import CommandBuffer, SingleCommands
from moka.commands.commands import (
    Command,
)
from moka.commands.descriptors import RasterState
from moka.commands.draw_arrays import (
    concatenate,
    gather_instances,
    join,
    part,
    take,
)
from moka.commands.draws import (
    DRAW,
    INSTANCE,
    Draws,
    Instances,
)
from moka.commands.handles import Handle
from moka.commands.recording import DrawSpan, Recording
from moka.commands.sort_key import SortKey
from moka.core.errors import CommandError

__all__ = ["CommandList"]

_MAXIMUM_KEY = (1 << 64) - 1


class CommandList(SingleCommands):
    """The commands of one frame.

    Single commands can be recorded directly, each a buffer of its own:
    ``commands.clear(...)``, ``commands.draw(..., key=...)``. Without a key
    an entry takes the key of the entry before it, and since the sort is
    stable it stays right behind its predecessor's place in the recording.
    """

    def __init__(self) -> None:
        self._buffers: list[tuple[int, CommandBuffer]] = []
        self._buffer_order: list[int] = []
        self._bulk: list[tuple[int, int, int]] = []
        self._in_order = False  # There is one bulk and it is sorted.
        self._draws: list[Draws] = []
        self._draw_count = 0
        self._pieces: dict[int, tuple[Draws, Instances]] = {}
        self._instances: list[Instances] = []
        self._instance_count = 0
        self._states: dict[RasterState, int] = {}
        self._handles: set[Handle] = set()
        self._handle_sets: list[frozenset[Handle]] = []
        self._sequence = 0
        self._last_key = 0

    @property
    def is_empty(self) -> bool:
        """Whether nothing has been recorded."""
        return not self._buffers and not self._draw_count

    def command_buffer(self, key: SortKey | int | None = None) -> CommandBuffer:
        """A buffer whose commands run together at ``key``'s place."""
        value = self._last_key if key is None else int(key)
        if not 0 <= value <= _MAXIMUM_KEY:
            raise CommandError(f"sort key: {value} does not fit into 64 bits")
        self._last_key = value
        buffer = CommandBuffer(self)
        self._buffers.append((value, buffer))
        self._buffer_order.append(self._sequence)
        self._sequence += 1
        return buffer

    def state_index(self, state: RasterState) -> int:
        """The number that stands for ``state`` in rows of draws."""
        return self._states.setdefault(state, len(self._states))

    def use(self, handles: frozenset[Handle]) -> None:
        """Tell that rows of :meth:`draws` name these resources.

        Pass the same set again while it is unchanged: a device that has
        checked it once does not look at its members again.
        """
        self._handle_sets.append(handles)

    def draws(
        self, rows: Draws, instances: Instances, *, in_order: bool = False
    ) -> None:
        """Record many draws at once, each at the place its key tells.

        ``rows`` is an array of :data:`moka.commands.draws.DRAW` whose
        ``first_instance`` counts rows of ``instances``; it is not copied,
        so leave it alone until the frame is submitted. The resources that
        it names are told with :meth:`use`. With ``in_order`` the keys
        ascend, and instances stand in the order of the rows: a frame of one
        such array is put together without being sorted.
        """
        if rows.dtype != DRAW or instances.dtype != INSTANCE:
            raise CommandError("draws: rows need the dtypes DRAW and INSTANCE")
        if not len(rows):
            return
        ends = rows["first_instance"] + rows["instance_count"]
        if int(ends.max()) > len(instances):
            raise CommandError(
                "draws: a row names instances that are not there"
            )
        piece = rows, instances
        if self._instance_count:
            rows = rows.copy()
            rows["first_instance"] += np.uint32(self._instance_count)
        self._add_instances(instances)
        span = self._add_draws(rows, piece)
        self._bulk.append((self._sequence, span.start, span.stop))
        self._in_order = in_order and len(self._bulk) == 1
        self._sequence += len(rows)

    def finish(self, *, sort: bool = True) -> Recording:
        """What a backend executes, in key order or as recorded."""
        if sort and self._in_order:
            return self._insert_buffers()
        draws = concatenate(self._draws, DRAW)
        order = self._order(draws["key"], sort)
        steps, rows = self._steps(order)
        draws = take(draws, rows)
        instances = gather_instances(
            draws, concatenate(self._instances, INSTANCE)
        )
        return self._recording(steps, draws, instances)

    def _recording(
        self,
        steps: list[Command | DrawSpan],
        draws: Draws,
        instances: Instances,
    ) -> Recording:
        return Recording(
            tuple(steps),
            draws,
            instances,
            tuple(self._states),
            (frozenset(self._handles), *self._handle_sets),
        )

    def _insert_buffers(self) -> Recording:
        """The buffers placed among the rows of the one, sorted, bulk."""
        ((sequence, start, _),) = self._bulk
        bulk = self._pieces[start]
        keys = np.ascontiguousarray(bulk[0]["key"])
        steps: list[Command | DrawSpan] = []
        pieces: list[tuple[Draws, Instances]] = []
        placed = 0

        def place(rows: Draws, instances: Instances) -> None:
            nonlocal placed
            if len(rows):
                pieces.append((rows, instances))
                steps.append(DrawSpan(placed, placed + len(rows)))
                placed += len(rows)

        done = 0
        for number in sorted(
            range(len(self._buffers)), key=lambda each: self._buffers[each][0]
        ):
            key, buffer = self._buffers[number]
            is_before = self._buffer_order[number] < sequence
            side: Literal["left", "right"] = "left" if is_before else "right"
            here = int(np.searchsorted(keys, np.uint64(key), side))
            place(*part(bulk, done, here))
            done = here
            for entry in buffer._entries:
                if isinstance(entry, DrawSpan):
                    place(*self._pieces[entry.start])
                else:
                    steps.append(entry)
        place(*part(bulk, done, len(keys)))
        return self._recording(steps, *join(pieces))

    def _add_draws(
        self, rows: Draws, piece: tuple[Draws, Instances]
    ) -> DrawSpan:
        """``piece`` is the same rows, and the instances that they count."""
        span = DrawSpan(self._draw_count, self._draw_count + len(rows))
        self._draws.append(rows)
        self._pieces[span.start] = piece
        self._draw_count = span.stop
        return span

    def _add_instances(self, instances: Instances) -> int:
        first = self._instance_count
        self._instances.append(instances)
        self._instance_count += len(instances)
        return first

    def _order(
        self, draw_keys: NDArray[np.uint64], sort: bool
    ) -> NDArray[np.int64]:
        """Entries in order: draw rows as they are, buffer i as -1 - i."""
        buffer_keys = np.array([key for key, _ in self._buffers], np.uint64)
        spans = [np.arange(start, stop) for _, start, stop in self._bulk]
        rows = np.concatenate(spans) if spans else np.zeros(0, np.int64)
        entries = np.concatenate([-1 - np.arange(len(buffer_keys)), rows])
        sequence = np.concatenate(
            [
                np.array(self._buffer_order, np.int64),
                *(
                    np.arange(first, first + stop - start)
                    for first, start, stop in self._bulk
                ),
            ]
        )
        if len(spans) + bool(len(buffer_keys)) > 1:
            recorded = np.argsort(sequence, kind="stable")
            entries = entries[recorded]
        else:
            recorded = np.arange(len(entries))
        if not sort:
            return entries
        keys = np.concatenate([buffer_keys, draw_keys[rows]])[recorded]
        return entries[np.argsort(keys, kind="stable")]

    def _steps(
        self, order: NDArray[np.int64]
    ) -> tuple[list[Command | DrawSpan], NDArray[np.int64]]:
        """The order cut at command buffers; the draw rows in that order."""
        steps: list[Command | DrawSpan] = []
        rows: list[NDArray[np.int64]] = []
        placed = 0

        def place(span: NDArray[np.int64]) -> None:
            nonlocal placed
            if len(span):
                rows.append(span)
                steps.append(DrawSpan(placed, placed + len(span)))
                placed += len(span)

        start = 0
        for position in np.flatnonzero(order < 0).tolist():
            place(order[start:position])
            _, buffer = self._buffers[-1 - int(order[position])]
            for entry in buffer._entries:
                if isinstance(entry, DrawSpan):
                    place(np.arange(entry.start, entry.stop))
                else:
                    steps.append(entry)
            start = position + 1
        place(order[start:])
        return steps, (np.concatenate(rows) if rows else np.zeros(0, np.int64))
