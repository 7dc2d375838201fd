"""Progressive accumulation: many sampled frames become one picture.

Each frame samples the light of every pixel a few times, through another
point of the pixel, which makes edges smooth. A run of frames is a batch,
randomised anew, so that the spread of the batches' means tells the error of
the mean of all of them. Tiles whose error is small enough are sampled no
more, and those that nobody sees not yet.
"""

import math
from collections.abc import Hashable

import numpy as np

from moka.commands.command_buffer import CommandBuffer
from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.descriptors import (
    Attachment,
    BindGroupDescriptor,
    BlendState,
    BufferDescriptor,
    BufferUsage,
    CullMode,
    FramebufferDescriptor,
    PixelFormat,
    RasterState,
    TextureBinding,
    TextureDescriptor,
    UniformBinding,
)
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FULLSCREEN, FullscreenPasses
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.renderer.convergence import (
    TILE,
    Convergence,
    Schedule,
    rectangles,
    tiles_of,
)
from moka.renderer.targets import Targets

__all__ = ["Progressive"]

# Roberts 2018: the sequence whose points keep most apart in two dimensions.
_GOLDEN = (0.7548776662466927, 0.5698402909980532)

_ACCUMULATION = UniformLayout(
    "Accumulation",
    (
        Parameter("frames", ParameterType.INT),
        Parameter("tile", ParameterType.INT),
    ),
)
_ADD = RasterState(
    cull=CullMode.NONE,
    depth_test=None,
    depth_write=False,
    blend=BlendState.ADDITIVE,
)


class Progressive:
    """The accumulators of one picture and how far it has come.

    Per frame: :meth:`begin`, then, unless :attr:`is_finished`, draw with
    :attr:`jitter` and :attr:`sample_range` into the scene's target, whose
    other tiles :meth:`mask` keeps from being drawn, and
    :meth:`accumulate`.
    """

    def __init__(
        self, device: GraphicsDevice, passes: FullscreenPasses
    ) -> None:
        self._device = device
        self._passes = passes
        self._key: Hashable = None
        self._size = (0, 0)
        self._resources: list[Handle] = []
        self._schedule = Schedule.of(1)
        self._convergence = Convergence((1, 1), None, 1)
        self._frame = 0
        self._report: Readback | None = None
        self._uniforms = device.create_buffer(
            BufferDescriptor(
                BufferUsage.UNIFORM, _ACCUMULATION.size, dynamic=True
            ),
            np.zeros(_ACCUMULATION.size, np.uint8),
        )

    def begin(
        self,
        key: Hashable,
        targets: Targets,
        samples: int,
        max_error: float | None,
        area: tuple[int, int, int, int] | None = None,
    ) -> None:
        """Go on with the picture ``key`` stands for, or start it.

        ``key`` is all that the radiance depends on, ``targets`` what frames
        are drawn into, ``samples`` those of a pixel, rounded up to whole
        batches, ``max_error`` the relative standard error that is enough.
        Tiles outside of ``area`` (x, y, width, height from the lower left)
        are not sampled; they begin when it comes to them.
        """
        size = targets.size
        if size != self._size or targets.scene_texture != self._source:
            self.forget()
            self._allocate(targets)
            self._key = None
        key = (key, samples, max_error)
        if key != self._key:
            self._key = key
            self._schedule = Schedule.of(
                samples, stops_early=max_error is not None
            )
            tiles = tiles_of(None, size)
            self._convergence = Convergence(
                tiles.shape, max_error, self._schedule.batches
            )
            self._frame = 0
            self._report = None
        if self._convergence.see(tiles_of(area, size)):
            # A batch that not all of them have from its start is none.
            self._frame -= self._frame % self._schedule.frames
        self.take_report()

    def take_report(self) -> None:
        """Look at what the GPU has told about the tiles, if it has."""
        if self._report is not None and self._report.data is not None:
            self._convergence.update(self._report.data)
            self._report = None

    @property
    def is_finished(self) -> bool:
        """Whether no frame is left to be drawn."""
        return self._convergence.is_reached

    @property
    def jitter(self) -> tuple[float, float]:
        """Where in the pixel this frame looks, -0.5 to 0.5; first (0, 0)."""
        x, y = (
            math.fmod(0.5 + self._frame * step, 1.0) - 0.5 for step in _GOLDEN
        )
        return x, y

    @property
    def sample_range(self) -> tuple[int, int, int, int]:
        """The parameter of that name of the block Frame."""
        batch, frame = divmod(self._frame, self._schedule.frames)
        count = self._schedule.samples
        return frame * count, count, batch, 0

    @property
    def samples_per_pixel(self) -> float:
        """Samples so far, as the mean over pixels."""
        batch = self._schedule.frames * self._schedule.samples
        return self._convergence.mean_batches * batch

    @property
    def estimated_error(self) -> float | None:
        """The largest relative standard error of a tile, when known."""
        return self._convergence.error

    def mask(self, buffer: CommandBuffer, nearest: float) -> None:
        """Let nothing be drawn in tiles that are not sampled.

        To be recorded after the clear of the scene's target; ``nearest`` is
        the depth that nothing is nearer than.
        """
        done = ~self._convergence.active
        for rectangle in rectangles(done, self._size):
            buffer.scissor(rectangle)
            buffer.clear(depth=nearest)
        buffer.scissor(None)

    def accumulate(
        self, commands: CommandList, key: SortKey, targets: Targets
    ) -> None:
        """Add what was drawn, and leave the mean so far in its place."""
        buffer = commands.command_buffer(key)
        frame = self._frame % self._schedule.frames
        active = rectangles(self._convergence.active, self._size)
        if self._frame == 0:
            buffer.bind_framebuffer(self._sum_target)
            buffer.clear((0.0, 0.0, 0.0, 0.0))
        buffer.bind_framebuffer(self._batch_target)
        # The first frame of a batch replaces what the last batch left.
        state = _ADD if frame else FULLSCREEN
        self._draw(buffer, "accumulate.frag", self._from_frame, state, active)
        self._frame += 1
        buffer.fill_buffer(
            self._uniforms,
            _ACCUMULATION.pack({"frames": frame + 1, "tile": TILE}),
        )
        if frame + 1 == self._schedule.frames:
            self._end_batch(buffer, active)
        seen = rectangles(self._convergence.seen, self._size)
        buffer.bind_framebuffer(targets.scene)
        self._draw(
            buffer, "resolve_samples.frag", self._from_sums, FULLSCREEN, seen
        )

    def forget(self) -> None:
        """Destroy what refers to targets that are about to go."""
        self._device.destroy(*reversed(self._resources))
        self._resources.clear()
        self._size = (0, 0)
        self._source: Handle | None = None

    def _end_batch(
        self, buffer: CommandBuffer, active: list[tuple[int, int, int, int]]
    ) -> None:
        self._convergence.end_batch()
        buffer.bind_framebuffer(self._sum_target)
        self._draw(
            buffer, "accumulate_batch.frag", self._from_batch, _ADD, active
        )
        buffer.bind_framebuffer(self._tile_target)
        self._draw(buffer, "tile_error.frag", self._from_moments, FULLSCREEN)
        rows, columns = self._convergence.seen.shape
        self._report = buffer.read_pixels(
            self._tile_target, (0, 0, columns, rows)
        )

    def _draw(
        self,
        buffer: CommandBuffer,
        fragment: str,
        group: Handle,
        state: RasterState,
        scissors: list[tuple[int, int, int, int]] | None = None,
    ) -> None:
        program = self._passes.program(fragment)
        for rectangle in [None] if scissors is None else scissors:
            buffer.scissor(rectangle)
            buffer.draw(program, self._passes.triangle, group, state)

    def _allocate(self, targets: Targets) -> None:
        self._size = size = targets.size
        self._source = targets.scene_texture
        tiles = (-(-size[0] // TILE), -(-size[1] // TILE))
        batch = self._texture("batch", size)
        total = self._texture("sum of batches", size)
        moments = self._texture("moments of batches", size)
        self._batch_target = self._framebuffer(batch)
        self._sum_target = self._framebuffer(total, moments)
        self._tile_target = self._framebuffer(
            self._texture("errors of tiles", tiles)
        )
        uniforms = self._uniforms
        self._from_frame = self._group(None, radiance_map=self._source)
        self._from_batch = self._group(uniforms, batch_map=batch)
        self._from_moments = self._group(uniforms, moment_map=moments)
        self._from_sums = self._group(
            uniforms, batch_map=batch, sum_map=total, moment_map=moments
        )

    def _texture(self, label: str, size: tuple[int, int]) -> Handle:
        return self._keep(
            self._device.create_texture(
                TextureDescriptor(PixelFormat.RGBA32F, *size, label=label)
            )
        )

    def _framebuffer(self, *textures: Handle) -> Handle:
        colour = tuple(Attachment(texture) for texture in textures)
        return self._keep(
            self._device.create_framebuffer(FramebufferDescriptor(colour))
        )

    def _group(self, uniforms: Handle | None, **maps: Handle) -> Handle:
        bound = tuple(
            TextureBinding(name, handle) for name, handle in maps.items()
        )
        blocks = (UniformBinding("Accumulation", uniforms),) if uniforms else ()
        return self._keep(
            self._device.create_bind_group(BindGroupDescriptor(bound, blocks))
        )

    def _keep(self, handle: Handle) -> Handle:
        self._resources.append(handle)
        return handle
