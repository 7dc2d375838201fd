"""Full-screen passes into faces and levels of cubes.

They run in one go; or in pieces, between which the GPU draws pictures.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
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
from moka.lighting.environment_maps import CUBE_FORMAT

__all__ = ["CUBE_FACES", "PreintegrationPasses", "Told"]

#: Gets how many pieces are done, and of how many; what it raises ends them.
Told = Callable[[int, int], None]

# What a piece reads of textures at most, unless one row is more: 40 ms of
# two cores without a GPU, less than a millisecond of any GPU.
_READS_OF_A_PIECE = 1 << 21

#: +X -X +Y -Y +Z -Z, in the order of a cube map's layers.
CUBE_FACES = range(6)


class PreintegrationPasses:
    """Passes in one command list, and what they need meanwhile.

    With ``told`` they are in many, each as long as others may have to wait
    for theirs; what they draw is the same.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        told: Told | None = None,
    ) -> None:
        self._device = device
        self._passes = passes
        self._told = told
        self._pieces = [CommandList()]
        self._reads = 0  # Of the last piece.
        self._scratch: list[Handle] = []

    def cube(self, size: int, levels: int = 1) -> Handle:
        """A cube map of radiance, which is the caller's."""
        cube = self._device.create_texture(
            TextureDescriptor(CUBE_FORMAT, size, size, TextureKind.CUBE, levels)
        )
        self.pause()
        return cube

    def pause(self) -> None:
        """Let others have the GPU before more follows, if one is told."""
        if self._told is not None:
            self._device.finish()

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
        defines: Mapping[str, str | int],
        faces: Sequence[int] = CUBE_FACES,
        samples: bytes = b"",
        reads: int = 1,
    ) -> None:
        """Draw ``faces``, all or one, of a level of ``size`` texels.

        ``samples`` is the block ``PrefilterSamples``, where there is one;
        for a texel the program reads textures ``reads`` times.
        """
        if len(faces) == 1:
            defines = {**defines, "MOKA_FACE": faces[0]}
        uniforms = (
            (UniformBinding("PrefilterSamples", self._buffer(samples)),)
            if samples
            else ()
        )
        self.draw(
            fragment,
            defines,
            [Attachment(cube, level, face) for face in faces],
            BindGroupDescriptor((source,), uniforms),
            rows=size,
            row_reads=len(faces) * size * reads,
        )

    def copy_faces(
        self, source: Handle, target: Handle, faces: Collection[int]
    ) -> None:
        """Copy level 0 of ``faces`` to another cube of the same size."""
        for face in faces:
            one, other = (
                self._framebuffer([Attachment(cube, 0, face)])
                for cube in (source, target)
            )
            self._pieces[-1].command_buffer().resolve(one, other)

    def draw(
        self,
        fragment: str,
        defines: Mapping[str, str | int],
        targets: Sequence[Attachment],
        bindings: BindGroupDescriptor | None = None,
        *,
        rows: int = 1,
        row_reads: int = 0,
    ) -> None:
        """Record one pass into ``targets``, its outputs.

        They have ``rows`` of texels, for each of which the program reads
        textures ``row_reads`` times.
        """
        framebuffer = self._framebuffer(targets)
        group = self._keep(
            self._device.create_bind_group, bindings or BindGroupDescriptor()
        )
        program = self._passes.program(fragment, defines)
        for band in self._bands(rows, row_reads):
            buffer = self._pieces[-1].command_buffer()
            buffer.bind_framebuffer(framebuffer)
            if band is not None:
                first, count = band
                # As many columns: faces are squares.
                buffer.scissor((0, first, rows, count))
            buffer.draw(program, self._passes.triangle, group, FULLSCREEN)

    def run(self) -> None:
        """Submit the passes and let go of what only they needed.

        Their time is the statistics' stage ``environment``. Pieces are
        waited for, so that no two of them delay a picture.
        """
        try:
            for number, commands in enumerate(self._pieces):
                self._device.submit(
                    commands, sort=False, stage="environment", paced=False
                )
                if self._told is not None:
                    self.pause()
                    self._told(number + 1, len(self._pieces))
        finally:
            # Users of a resource go before it.
            self._device.destroy(*reversed(self._scratch))

    def _bands(
        self, rows: int, row_reads: int
    ) -> Iterator[tuple[int, int] | None]:
        """First rows and numbers of rows, each for the piece that is last.

        None is all of them.
        """
        if self._told is None:
            yield None
            return
        most = max(_READS_OF_A_PIECE // max(row_reads, 1), 1)
        for first in range(0, rows, most):
            count = min(most, rows - first)
            reads = count * row_reads
            if self._reads and self._reads + reads > _READS_OF_A_PIECE:
                self._pieces.append(CommandList())
                self._reads = 0
            self._reads += reads
            yield first, count

    def _framebuffer(self, targets: Sequence[Attachment]) -> Handle:
        return self._keep(
            self._device.create_framebuffer,
            FramebufferDescriptor(tuple(targets)),
        )

    def _buffer(self, data: bytes) -> Handle:
        return self._keep(
            lambda descriptor: self._device.create_buffer(descriptor, data),
            BufferDescriptor(BufferUsage.UNIFORM, len(data)),
        )

    def _keep(self, create: Callable[[Any], Handle], descriptor: Any) -> Handle:
        return self.scratch(create(descriptor))
