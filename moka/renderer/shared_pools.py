"""What renderers beside each other share of one device."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.graphics.program_cache import ProgramCache
from moka.lighting.disk_cache import DiskCache
from moka.renderer.geometry import GeometryPool
from moka.renderer.material_pool import MaterialPool
from moka.renderer.texture_settings import TextureSettings

if TYPE_CHECKING:
    from moka.model.mesh import Primitive
    from moka.renderer.geometry import Upload

__all__ = ["SharedPools"]


class SharedPools:
    """Programs, geometry, materials with their textures, and a disk cache.

    ``materials`` may have begun already; ``cache`` is where preintegrated
    lighting is kept.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        statistics: Statistics,
        materials: MaterialPool | None,
        cache: DiskCache | None,
    ) -> None:
        self.passes = FullscreenPasses(device)
        self.programs = ProgramCache(device)
        self.geometry = GeometryPool(device)
        self.materials = materials or MaterialPool(device, statistics)
        self.cache = cache

    def prepare_geometry(
        self,
        primitives: "Sequence[Primitive]",
        settings: TextureSettings,
        told: Callable[[str, int, int], None],
    ) -> "list[Upload]":
        """Decode and upload what ``primitives`` are drawn with.

        See :meth:`moka.Renderer.prepare_geometry`.
        """
        materials = self.materials.begin_primitives(primitives, settings)
        attributes = [each.attributes for each in materials.descriptions]
        # While the images decode.
        uploads = self.geometry.make(
            list(zip(primitives, attributes, strict=True)),
            partial(told, "meshes"),
        )
        self.materials.finish(materials, partial(told, "images"))
        return uploads
