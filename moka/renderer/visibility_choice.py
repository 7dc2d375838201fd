"""When a scene is drawn through a visibility buffer.

It is where this is faster, and only for what it can show: opaque, rigid
triangles of one program, one set of textures and one page of the material
table, in one pair of buffers. What else there is, forward shading draws as
well or better.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from moka.commands.descriptors import Topology
from moka.graphics.device import GraphicsDevice
from moka.material.description import Feature, MaterialDescription
from moka.model.mesh import Primitive
from moka.renderer.geometry import GeometryPool
from moka.renderer.permutation import materials_layout, row_parts
from moka.renderer.settings import RenderSettings

if TYPE_CHECKING:
    from moka.renderer.scene_materials import SceneMaterials
    from moka.scene.drawables import Drawables

__all__ = ["VisibilityChoice"]

#: With fewer triangles, to note what is seen costs more than it saves: on
#: llvmpipe 100 cubes, 1200 triangles, take the same time in both ways.
FEWEST_TRIANGLES = 2000

_UNSUITED = (
    Feature.ALPHA_BLEND | Feature.ALPHA_MASK | Feature.POINTS | Feature.LINES
)


class VisibilityChoice:
    """Decides for the frames of one renderer, as long as a scene stays."""

    def __init__(self, device: GraphicsDevice, geometry: GeometryPool) -> None:
        self._device = device
        self._geometry = geometry
        self._decided: tuple[object, ...] = ()
        self._samples = 0

    def samples(
        self,
        settings: RenderSettings,
        materials: "SceneMaterials",
        drawables: "Drawables",
    ) -> int:
        """How many samples of each pixel to look at, 0 to shade forward."""
        key = (
            materials,
            drawables,
            settings.shading,
            settings.samples,
            settings.ibl,
        )
        if self._decided != key:
            self._decided = key
            self._samples = 0
            if self._is_wanted(settings) and self._suits(
                settings, materials, drawables
            ):
                self._samples = self._drawn_samples(settings)
        return self._samples

    def _drawn_samples(self, settings: RenderSettings) -> int:
        return min(settings.samples, self._device.info.max_samples)

    def _is_wanted(self, settings: RenderSettings) -> bool:
        info = self._device.info
        return (
            not settings.accumulates  # which smooths edges over frames
            and info.clip_control
            # Whole numbers can have fewer samples than radiance.
            and self._drawn_samples(settings) <= info.max_integer_samples
            and (
                settings.shading == "visibility"
                # GPUs shade small blocks, and only what is seen of them.
                or (settings.shading == "auto" and info.is_software)
            )
        )

    def _suits(
        self,
        settings: RenderSettings,
        materials: "SceneMaterials",
        drawables: "Drawables",
    ) -> bool:
        if not materials.descriptions:
            return False
        description = materials.descriptions[0]
        primitives = [drawables.primitives[index] for index in materials.drawn]
        page = materials_layout(row_parts(description)).rows
        if (
            description.features & _UNSUITED
            or description.deforms
            or not materials.are_alike
            or len(set(materials.materials)) > page
            or any(
                each.topology is not Topology.TRIANGLES for each in primitives
            )
        ):
            return False
        rows = len(drawables.primitive)
        if not self._can_be_read(primitives, description.attributes, rows):
            return False
        triangles = np.zeros(len(drawables.primitives), np.intp)
        triangles[list(materials.drawn)] = [
            (each.index_count or each.vertex_count) // 3 for each in primitives
        ]
        if int(triangles.max()).bit_length() + rows.bit_length() > 32:
            return False  # Too many for a number in the buffer.
        drawn = int(triangles[drawables.primitive].sum())
        return settings.shading == "visibility" or (
            drawn >= FEWEST_TRIANGLES and _is_dear(settings, description)
        )

    def _can_be_read(
        self,
        primitives: Sequence[Primitive],
        attributes: tuple[str, ...],
        rows: int,
    ) -> bool:
        """Whether this driver has textures for what the shader looks up.

        For vertices and indices, if they are in one pair of buffers, and for
        as many rows of instances.
        """
        from moka.renderer.visible_geometry import (
            INSTANCE_TEXELS,
            vertex_texels,
        )

        size = self._geometry.joined_size(
            [(each, attributes) for each in primitives]
        )
        if size is None:
            return False
        vertices, indices = size
        texels = (
            vertices * vertex_texels(attributes),
            indices,
            rows * INSTANCE_TEXELS,
        )
        return max(texels) <= self._device.info.max_buffer_texels


def _is_dear(
    settings: RenderSettings, description: MaterialDescription
) -> bool:
    """Whether to shade takes longer than to look up what is seen.

    With one sample hidden surfaces are not shaded anyway, and without
    textures shading is cheap: 10 000 cubes then take 1.08 of the time.
    """
    return settings.samples > 1 or bool(description.textures)
