"""The poses of a scene on the GPU: joint matrices and active morph targets.

A buffer texture: a vertex shader of OpenGL 3.3 reads it by number, it holds
what a uniform block cannot (16 KiB are 341 joints), and on a software driver
fetches from it take three quarters of the time of those from a 2D texture
(``tests/benchmarks/bare_skinning.py``). Every skin and every morphed draw
has its place for good, which instances name; a frame writes from the first
to the last texel of what it shows and what has moved, in one call, and
nothing where nothing has.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    PixelFormat,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.sort_key import SortKey
from moka.core.errors import ModelError
from moka.graphics.device import GraphicsDevice
from moka.material.description import MaterialDescription
from moka.model.mesh import Primitive
from moka.renderer.geometry import GeometryPool
from moka.renderer.morph_deltas import MorphDeltas, TargetPlaces
from moka.renderer.scene_materials import SceneMaterials
from moka.scene.morph_poses import MorphGroup
from moka.scene.poses import Poses

__all__ = ["PoseTexture"]


class PoseTexture:
    """What the vertex shader reads of ``poses``.

    ``places`` uint32 (D, 2) are, for each draw, the first texel of its skin
    and of its list of targets. Raises ModelError if a texture cannot hold
    it all.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        poses: Poses,
        primitives: Sequence[Primitive],
        materials: SceneMaterials,
    ) -> None:
        self.made_for = materials
        self._device = device
        self._poses = poses
        descriptions = dict(
            zip(materials.drawn, materials.descriptions, strict=True)
        )
        self._meshes = {
            index: (primitives[index], description.attributes)
            for index, description in descriptions.items()
        }
        skins = poses.skins
        self._groups: list[tuple[MorphGroup, TargetPlaces]] = []
        self._deltas = self._find_deltas(device, descriptions)
        self.places = np.zeros((len(poses.skin), 2), np.uint32)
        self.places[:, 0] = 3 * np.append(skins.first, 0)[poses.skin]
        joints = count = 3 * len(skins.rows)
        for group, _ in self._groups:
            size = 1 + len(group.targets)
            ends = count + size * np.arange(1, len(group.draws) + 1)
            self.places[group.draws, 1] = ends - size
            count = int(ends[-1])
        count = max(count, 1)
        largest = device.info.max_buffer_texels
        if count > largest:
            raise ModelError(
                f"poses: {len(skins.rows)} joints and {count - joints} active "
                f"morph targets are more than the {largest} texels that this "
                "driver holds in a texture"
            )
        self._texels = np.zeros((count, 4), np.float32)
        self._joints = self._texels[:joints].reshape(-1, 3, 4)
        self._written_skins = np.zeros(len(skins), np.int64)
        self._written_draws = np.zeros(len(poses.skin), np.int64)
        self.texture = device.create_texture(
            TextureDescriptor(
                PixelFormat.RGBA32F, count, 1, TextureKind.BUFFER, label="poses"
            )
        )

    @property
    def bindings(self) -> tuple[TextureBinding, ...]:
        """The textures as the shader names them."""
        poses = TextureBinding("poses", self.texture)
        if self._deltas is None:
            return (poses,)
        texture = self._deltas.texture
        return (poses, TextureBinding("morph_deltas", texture))

    def destroy(self) -> None:
        """Free the textures."""
        self._device.destroy(self.texture)
        if self._deltas is not None:
            self._deltas.destroy()

    def update(
        self,
        visible: NDArray[np.intp],
        geometry: GeometryPool,
        commands: CommandList,
    ) -> None:
        """Write what of the draws ``visible`` (V,) is not there yet.

        Recorded before all passes. ``geometry`` holds their meshes.
        """
        seen = np.zeros(len(self._poses.skin), np.bool_)
        seen[visible] = True
        written = self._write_skins(visible)
        for group, places in self._groups:
            written += self._write_lists(group, places, seen, geometry)
        if written:
            first, last = min(written), max(written)
            commands.fill_texture(
                self.texture,
                self._texels[first : last + 1],
                first,
                key=SortKey(0),
            )

    def _write_skins(self, visible: NDArray[np.intp]) -> list[int]:
        """The first and the last texel that skins changed, if any."""
        skins = self._poses.skins
        stale = np.zeros(len(skins) + 1, np.bool_)
        stale[self._poses.skin[visible]] = True
        stale = stale[:-1] & (self._written_skins != skins.version)
        if not stale.any():
            return []
        self._written_skins[stale] = skins.version[stale]
        joints = np.flatnonzero(stale[skins.skin_of_joint])
        # What float32 cannot hold is infinite, and not drawn.
        with np.errstate(over="ignore"):
            self._joints[joints] = skins.matrices[joints]
        return [3 * int(joints[0]), 3 * int(joints[-1]) + 2]

    def _write_lists(
        self,
        group: MorphGroup,
        places: TargetPlaces,
        seen: NDArray[np.bool_],
        geometry: GeometryPool,
    ) -> list[int]:
        """The first and the last texel that lists changed, if any."""
        version = self._poses.morphs.version
        draws = group.draws
        stale = np.flatnonzero(
            seen[draws] & (self._written_draws[draws] != version[draws])
        )
        if not len(stale):
            return []
        draws = draws[stale]
        self._written_draws[draws] = version[draws]
        weights = self._poses.morphs.values[group.places[stale]]
        active = (weights != 0) & places.shows
        first = self.places[draws, 1].astype(np.intp)
        count = active.sum(axis=1)
        begin = geometry.base_vertex(*self._meshes[group.primitive])
        heads = self._texels[first]
        heads[:, 0] = count
        heads[:, 1:3] = divmod(begin, 4096)
        self._texels[first] = heads
        row, target = np.nonzero(active)
        texel = first[row] + np.cumsum(active, axis=1)[row, target]
        self._texels[texel, 0] = weights[row, target]
        self._texels[texel, 1:] = places.entries[target]
        return [int(first.min()), int((first + count).max())]

    def _find_deltas(
        self,
        device: GraphicsDevice,
        descriptions: Mapping[int, MaterialDescription],
    ) -> MorphDeltas | None:
        """The deltas that are read; sets the groups that read them."""
        groups = [
            group
            for group in self._poses.morphs.groups
            if group.primitive in descriptions
            and descriptions[group.primitive].morphed
        ]
        if not groups:
            return None
        deltas = MorphDeltas(
            device,
            [
                (group.targets, descriptions[group.primitive].morphed)
                for group in groups
            ],
        )
        self._groups = list(zip(groups, deltas.places, strict=True))
        return deltas
