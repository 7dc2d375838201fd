"""What a backend does: make resources, execute recordings, read back.

All methods are called on one thread, the render thread. Handles have been
checked by the device; a backend trusts them.
"""

from collections.abc import Sequence
from typing import Any, Protocol

from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.descriptors import (
    BindGroupDescriptor,
    BufferDescriptor,
    FramebufferDescriptor,
    MeshDescriptor,
    PixelFormat,
    ProgramDescriptor,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.commands.recording import Recording

__all__ = ["Backend", "BackendInfo", "FrameCounters", "TextureData"]

# One array per mip level: (height, width, channels), top row first; for cube
# maps (6, size, size, channels).
TextureData = Sequence[NDArray[Any]]


class BackendInfo(Struct, frozen=True):
    """Facts about the driver that layers above may act on.

    ``max_samples`` are those of a texture that is drawn into,
    ``max_integer_samples`` those of one of whole numbers.
    ``compressed_formats`` are those of blocks that it samples at no loss.
    """

    kind: str
    vendor: str = ""
    renderer: str = ""
    version: str = ""
    max_samples: int = 1
    max_integer_samples: int = 1
    max_texture_size: int = 2048
    max_buffer_texels: int = 65536
    max_anisotropy: float = 1.0
    max_uniform_block_size: int = 16384
    uniform_alignment: int = 256
    max_texture_units: int = 16
    clip_control: bool = False
    multi_draw_indirect: bool = False
    compressed_formats: frozenset[PixelFormat] = frozenset()

    @property
    def is_software(self) -> bool:
        """Whether the CPU draws: Mesa's and SwiftShader's rasterisers."""
        name = self.renderer.lower()
        return any(
            each in name for each in ("llvmpipe", "softpipe", "swiftshader")
        )


class FrameCounters(Struct):
    """Work done and skipped while one recording was executed."""

    draw_packets: int = 0
    gl_draws: int = 0
    state_changes: int = 0
    state_changes_skipped: int = 0
    bytes_uploaded: int = 0


class Backend(Protocol):
    """The implementation side of the bridge behind GraphicsDevice."""

    info: BackendInfo

    def create_buffer(
        self, handle: Handle, descriptor: BufferDescriptor, data: Any
    ) -> None:
        """Make a buffer; ``data`` is bytes-like or None (undefined)."""

    def create_texture(
        self,
        handle: Handle,
        descriptor: TextureDescriptor,
        data: TextureData | None,
    ) -> None:
        """Make a texture with the levels of ``data`` or undefined texels."""

    def create_program(
        self, handle: Handle, descriptor: ProgramDescriptor
    ) -> None:
        """Begin to compile and link; nobody waits for it."""

    def finish_programs(self, handles: Sequence[Handle] | None = None) -> None:
        """Return when ``handles`` are linked, or all that have begun.

        :meth:`execute` begins with the latter. Raises ShaderError for the
        first, in the order of their making, that is not; it is destroyed.
        """

    def create_mesh(self, handle: Handle, descriptor: MeshDescriptor) -> None:
        """Make a mesh."""

    def create_framebuffer(
        self, handle: Handle, descriptor: FramebufferDescriptor
    ) -> None:
        """Make a framebuffer; raises DeviceError if it is incomplete."""

    def create_bind_group(
        self, handle: Handle, descriptor: BindGroupDescriptor
    ) -> None:
        """Make a bind group."""

    def destroy(self, handle: Handle) -> None:
        """Free a resource that no later recording uses."""

    def execute(
        self, recording: Recording, stage: str = "frame"
    ) -> FrameCounters:
        """Run a recording; its time counts for ``stage``.

        What was uploaded counts with the next one that is a frame.
        """

    def read_texture(
        self, handle: Handle, level: int, face: int
    ) -> NDArray[Any]:
        """The texels of one level as stored: (height, width, channels)."""

    def stage_seconds(self) -> dict[str, float]:
        """Where time went: compile, upload, readback, stages of execute."""

    def finish(self) -> None:
        """Return when the GPU has done all that was asked."""

    def poll(self) -> bool:
        """Take up pixels that have arrived; whether some still have to."""

    def present(self) -> None:
        """Show what was drawn into the window."""

    def close(self) -> None:
        """Free everything; may be called twice."""
