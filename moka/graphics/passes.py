"""Full-screen passes: a program run once over a framebuffer.

Their shaders make one triangle from ``gl_VertexID`` and read what they need
from uniform blocks, like every other draw.
"""

from collections.abc import Mapping
from types import MappingProxyType

from moka.commands.descriptors import (
    CullMode,
    MeshDescriptor,
    ProgramDescriptor,
    RasterState,
    Topology,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.program_cache import ProgramCache
from moka.graphics.shader_source import load_shader

__all__ = ["FULLSCREEN", "FullscreenPasses"]

# Neither depth nor culling nor blending: every pixel, once.
FULLSCREEN = RasterState(cull=CullMode.NONE, depth_test=None, depth_write=False)

_NOTHING: Mapping[str, str | int] = MappingProxyType({})


class FullscreenPasses:
    """The triangle and the programs of the full-screen passes."""

    def __init__(self, device: GraphicsDevice) -> None:
        self._programs = ProgramCache(device)
        self.triangle = device.create_mesh(
            MeshDescriptor(Topology.TRIANGLES, 3)
        )

    def __len__(self) -> int:
        """How many programs are loaded."""
        return len(self._programs)

    def reload(self) -> int:
        """:meth:`ProgramCache.reload` of the passes' programs."""
        return self._programs.reload()

    def program(
        self,
        fragment: str,
        defines: Mapping[str, str | int] = _NOTHING,
        *,
        vertex: str = "fullscreen.vert",
    ) -> Handle:
        """The program of ``shaders/<fragment>`` with these defines.

        ``vertex`` makes the triangle.
        """
        return self._programs.get(
            (vertex, fragment, tuple(sorted(defines.items()))),
            lambda: ProgramDescriptor(
                load_shader(vertex, defines),
                load_shader(fragment, defines),
                fragment,
            ),
        )
