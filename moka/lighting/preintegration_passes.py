"""Full-screen passes into faces and levels of cubes, run in one go."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BufferDescriptor,
    BufferUsage,
    FramebufferDescriptor,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
    UniformBinding,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FULLSCREEN, FullscreenPasses
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.lighting.environment_maps import CUBE_FORMAT

__all__ = ["PreintegrationPasses"]

_CUBE_FACE = UniformLayout(
    "CubeFace",
    (
        Parameter("face", ParameterType.INT),
        Parameter("size", ParameterType.INT),
        Parameter("subdivisions", ParameterType.INT),
        Parameter("source_lod", ParameterType.FLOAT),
    ),
)


class PreintegrationPasses:
    """Passes in one command list, and what they need meanwhile."""

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._commands = CommandList()
        self._scratch: list[Handle] = []

    def cube(self, size: int, levels: int = 1) -> Handle:
        """A cube map of radiance, which is the caller's."""
        return self._device.create_texture(
            TextureDescriptor(CUBE_FORMAT, size, size, TextureKind.CUBE, levels)
        )

    def scratch(self, resource: Handle) -> Handle:
        """``resource``, which lives until :meth:`run`."""
        self._scratch.append(resource)
        return resource

    def kept(self, resource: Handle) -> Handle:
        """``resource``, which :meth:`run` does not destroy after all."""
        self._scratch.remove(resource)
        return resource

    def cube_level(
        self,
        fragment: str,
        cube: Handle,
        level: int,
        size: int,
        source: TextureBinding,
        *,
        defines: Mapping[str, str | int] | None = None,
        subdivisions: Sequence[int] = (1,) * 6,
        samples: bytes = b"",
    ) -> None:
        """Draw the six faces of one level, of ``size`` texels, of ``cube``.

        ``subdivisions`` are those of each face's texels, ``samples`` is the
        block ``PrefilterSamples``, where there is one.
        """
        uniforms = (
            (UniformBinding("PrefilterSamples", self._buffer(samples)),)
            if samples
            else ()
        )
        for face, divisions in enumerate(subdivisions):
            block = _CUBE_FACE.pack(
                {"face": face, "size": size, "subdivisions": divisions}
            )
            faces = UniformBinding("CubeFace", self._buffer(block.tobytes()))
            self.draw(
                fragment,
                defines or {},
                Attachment(cube, level, face),
                BindGroupDescriptor((source,), (*uniforms, faces)),
            )

    def draw(
        self,
        fragment: str,
        defines: Mapping[str, str | int],
        target: Attachment,
        bindings: BindGroupDescriptor | None = None,
    ) -> None:
        """Record one pass into ``target``."""
        framebuffer = self._keep(
            self._device.create_framebuffer, FramebufferDescriptor((target,))
        )
        group = self._keep(
            self._device.create_bind_group, bindings or BindGroupDescriptor()
        )
        buffer = self._commands.command_buffer()
        buffer.bind_framebuffer(framebuffer)
        buffer.draw(
            self._passes.program(fragment, defines),
            self._passes.triangle,
            group,
            FULLSCREEN,
        )

    def run(self) -> None:
        """Submit the passes and let go of what only they needed.

        Their time is the statistics' stage ``environment``.
        """
        self._device.submit(
            self._commands, sort=False, stage="environment", paced=False
        )
        # Users of a resource go before it.
        self._device.destroy(*reversed(self._scratch))

    def _buffer(self, data: bytes) -> Handle:
        return self._keep(
            lambda descriptor: self._device.create_buffer(descriptor, data),
            BufferDescriptor(BufferUsage.UNIFORM, len(data)),
        )

    def _keep(self, create: Callable[[Any], Handle], descriptor: Any) -> Handle:
        return self.scratch(create(descriptor))
