"""The rows of all materials on the GPU, in pages of one uniform block.

Materials with more parts have longer rows and pages of their own.
"""

from collections.abc import Collection, Hashable, Iterable, Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import BufferDescriptor, BufferUsage
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.material.material import Material
from moka.material.parameters import RowPart, material_values
from moka.renderer.permutation import materials_layout

__all__ = ["MaterialPlace", "MaterialTable"]


class MaterialPlace(Struct, frozen=True):
    """The page that holds a material, and its row there."""

    page: Handle
    row: int


class MaterialTable:
    """Places of materials; rows are written again where numbers change."""

    def __init__(
        self,
        device: GraphicsDevice,
        materials: Collection[tuple[Material, RowPart]],
    ) -> None:
        """Place each material, with parts of rows, in the GPU's pages."""
        self._device = device
        self._places: dict[Hashable, MaterialPlace] = {}
        self.pages: list[Handle] = []
        self._rows: dict[Handle, NDArray[np.void]] = {}
        self._parts = sorted({parts for _, parts in materials})
        for parts in self._parts:
            members = list(
                dict.fromkeys(
                    material for material, its in materials if its == parts
                )
            )
            self._write(members, parts)

    def place(self, material: Material, parts: RowPart) -> MaterialPlace:
        """Where ``material`` lies."""
        return self._places[material, parts]

    def update(
        self, changes: Iterable[tuple[Material, Material]]
    ) -> Iterator[tuple[Handle, NDArray[np.void], int]]:
        """Give places of materials the numbers of others.

        What to write: the page, rows of it, and at which byte these go.
        """
        spans: dict[Handle, tuple[int, int]] = {}
        for material, now in changes:
            for parts in self._parts:
                place = self._places.get((material, parts))
                if place is None:
                    continue
                row = place.row
                materials_layout(parts).fill(
                    self._rows[place.page][row : row + 1],
                    material_values(now, parts),
                )
                first, last = spans.get(place.page, (row, row))
                spans[place.page] = min(first, row), max(last, row)
        for page, (first, last) in spans.items():
            rows = self._rows[page]
            yield page, rows[first : last + 1], first * rows.itemsize

    def destroy(self) -> None:
        """Destroy the pages."""
        self._device.destroy(*self.pages)
        self.pages.clear()
        self._rows.clear()

    def _write(self, materials: list[Material], parts: RowPart) -> None:
        layout = materials_layout(parts)
        for start in range(0, len(materials), layout.rows):
            members = materials[start : start + layout.rows]
            rows = np.zeros(layout.rows, layout.dtype)
            for index, material in enumerate(members):
                layout.fill(
                    rows[index : index + 1], material_values(material, parts)
                )
            is_live = any(material.animated for material in members)
            page = self._device.create_buffer(
                BufferDescriptor(
                    BufferUsage.UNIFORM,
                    rows.nbytes,
                    dynamic=is_live,
                    label="materials",
                ),
                rows.tobytes(),
            )
            self.pages.append(page)
            self._rows[page] = rows
            for index, material in enumerate(members):
                self._places[material, parts] = MaterialPlace(page, index)
