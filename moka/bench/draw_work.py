"""Draws of many programs, materials and meshes, for a device without a GPU."""

from types import TracebackType

import numpy as np

from moka.backend.batching import MeshTable, merge_draws
from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    BindGroupDescriptor,
    MeshDescriptor,
    ProgramDescriptor,
    RasterState,
    ShaderText,
    Topology,
)
from moka.commands.draws import DRAW, INSTANCE
from moka.commands.sort_key import pack_opaque_keys
from moka.graphics.device import GraphicsDevice

__all__ = ["MOST_BY_HAND", "DrawWork"]

PROGRAMS, MATERIALS, MESHES = 8, 64, 32

#: An object per draw: more of them take too long to be worth knowing.
MOST_BY_HAND = 10_000


class DrawWork:
    """``number`` draws at random, and what a frame does with them.

    Each method is one step, complete in itself. Use it in a ``with`` block.
    """

    def __init__(self, number: int) -> None:
        self._backend = RecordingBackend()
        self._device = GraphicsDevice(lambda: self._backend)
        device = self._device
        text = ShaderText("void main() {}")
        self._programs = [
            device.create_program(ProgramDescriptor(text, text))
            for _ in range(PROGRAMS)
        ]
        self._groups = [
            device.create_bind_group(BindGroupDescriptor())
            for _ in range(MATERIALS)
        ]
        self._meshes = [
            device.create_mesh(MeshDescriptor(Topology.TRIANGLES, 3 * i + 3))
            for i in range(MESHES)
        ]
        self._table = MeshTable()
        for mesh in self._meshes:
            self._table.put(
                mesh.index, count=3, first=0, base_vertex=0, source=0,
                indexed=False,
            )  # fmt: skip
        self._handles = frozenset(
            (*self._programs, *self._groups, *self._meshes)
        )
        self._draw(number)
        self._commands = self._recorded()
        self._recording = self._commands.finish()
        self._state = RasterState()

    def __enter__(self) -> "DrawWork":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._device.close()

    @property
    def counts(self) -> dict[str, int]:
        """Draws, and the calls that a GPU backend makes of them."""
        batches = merge_draws(self._recording, self._table)
        return {
            "draw_packets": len(self._rows),
            "commands": len(batches.commands),
            "gl_draws": len(batches.program),
        }

    def record(self) -> None:
        """Record all as one array."""
        self._recorded()

    def record_by_hand(self) -> None:
        """Record them one by one, as a user may."""
        commands = CommandList()
        for key, program, mesh, group in self._by_hand:
            commands.draw(program, mesh, group, self._state, key=key)

    def sort(self) -> None:
        """Bring what was recorded in the order of its keys."""
        self._commands.finish()

    def merge(self) -> None:
        """Make batches of what was sorted."""
        merge_draws(self._recording, self._table)

    def submit(self) -> None:
        """Record, sort, hand over, merge on the other thread; wait."""
        self._device.submit(self._recorded()).wait()
        # It remembers every frame, which is not what is measured.
        self._backend.frames.clear()
        self._backend.batches.clear()

    def _draw(self, number: int) -> None:
        random = np.random.default_rng(1)
        program, group, mesh = (
            random.integers(0, most, number)
            for most in (PROGRAMS, MATERIALS, MESHES)
        )
        rows = self._rows = np.zeros(number, DRAW)
        for name, chosen, handles in (
            ("program", program, self._programs),
            ("bind_group", group, self._groups),
            ("mesh", mesh, self._meshes),
        ):
            rows[name] = np.array([handle.index for handle in handles])[chosen]
        rows["first_instance"] = np.arange(number)
        rows["instance_count"] = 1
        rows["key"] = pack_opaque_keys(
            program=program,
            material=group,
            mesh=mesh,
            depth=random.uniform(1, 100, number),
        )
        self._instances = np.zeros(number, INSTANCE)
        self._by_hand = [
            (
                int(rows["key"][index]),
                self._programs[program[index]],
                self._meshes[mesh[index]],
                self._groups[group[index]],
            )
            for index in range(min(number, MOST_BY_HAND))
        ]

    def _recorded(self) -> CommandList:
        commands = CommandList()
        commands.state_index(RasterState())
        commands.use(self._handles)
        commands.draws(self._rows, self._instances)
        return commands
