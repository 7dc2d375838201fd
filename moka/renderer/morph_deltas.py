"""What morph targets add to vertices, in one texture for a whole scene.

A texture and not vertex attributes, because targets can be hundreds and a
vertex reads only the few that are active. A target keeps the vertices from
the first to the last that it moves, so that one which opens an eye costs the
eye's vertices, in memory and in time.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import (
    PixelFormat,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.handles import Handle
from moka.core.errors import ModelError
from moka.graphics.device import GraphicsDevice
from moka.material.description import MORPH_TEXELS, morph_texels
from moka.model.morphs import MorphTargets

__all__ = ["MorphDeltas", "TargetPlaces"]

# Targets begin at multiples of this, so that a float32 holds where.
_ALIGNMENT = 16


class TargetPlaces(Struct, eq=False):
    """Where the T targets of one primitive are.

    ``entries`` float32 (T, 3) are what a list of active targets has behind
    the weight: the first vertex that is moved, how many from there on, and
    where their texels begin, in units of 16.
    """

    entries: NDArray[np.float32]

    @property
    def shows(self) -> NDArray[np.bool_]:
        """Which targets (T,) move anything."""
        return self.entries[:, 1] > 0


class MorphDeltas:
    """The deltas of several primitives, as far as shaders read them.

    ``wanted`` pairs targets with the attributes of them that count;
    ``places`` are in its order. Raises ModelError if they are more than a
    texture can hold.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        wanted: Sequence[tuple[MorphTargets, tuple[str, ...]]],
    ) -> None:
        self._device = device
        blocks: list[NDArray[np.float32]] = []
        self.places: list[TargetPlaces] = []
        count = 0
        for targets, morphed in wanted:
            entries = np.zeros((len(targets), 3), np.float32)
            for number in range(len(targets)):
                first, block = _texels(targets, number, morphed)
                if len(block):
                    entries[number] = first, len(block), count // _ALIGNMENT
                    padded = -(-block[..., 0].size // _ALIGNMENT) * _ALIGNMENT
                    texels = np.zeros((padded, 4), np.float32)
                    texels[: block[..., 0].size] = block.reshape(-1, 4)
                    blocks.append(texels)
                    count += padded
            self.places.append(TargetPlaces(entries))
        self.texture = self._upload(blocks, count)

    def destroy(self) -> None:
        """Free the texture."""
        self._device.destroy(self.texture)

    def _upload(
        self, blocks: Sequence[NDArray[np.float32]], count: int
    ) -> Handle:
        largest = self._device.info.max_buffer_texels
        if count > largest:
            raise ModelError(
                f"morph targets: {count} deltas are more than the {largest} "
                "that this driver holds in a texture"
            )
        texels = np.concatenate([np.zeros((0, 4), np.float32), *blocks])
        return self._device.create_texture(
            TextureDescriptor(
                PixelFormat.RGBA32F,
                max(count, 1),
                1,
                TextureKind.BUFFER,
                label="morph deltas",
            ),
            [texels] if count else None,
        )


def _texels(
    targets: MorphTargets, number: int, morphed: tuple[str, ...]
) -> tuple[int, NDArray[np.float32]]:
    """The first vertex that a target moves, and its texels (V, texels, 4).

    V is 0 if it moves none.
    """
    deltas = targets.deltas[number]
    given = {name: deltas[name] for name in morphed if name in deltas}
    moved = np.zeros(len(next(iter(given.values()), ())), np.bool_)
    for array in given.values():
        moved |= array.any(axis=1)
    vertices = np.flatnonzero(moved)
    slots = morph_texels(morphed)
    if not len(vertices):
        return 0, np.zeros((0, len(slots), 4), np.float32)
    first, last = int(vertices[0]), int(vertices[-1]) + 1
    block = np.zeros((last - first, len(slots), 4), np.float32)
    for texel, slot in slots.items():
        for place, name in enumerate(MORPH_TEXELS[texel]):
            if name in given:
                part = given[name][first:last]
                start = 2 * place
                block[:, slot, start : start + part.shape[1]] = part
    return first, block
