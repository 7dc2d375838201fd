"""What a frame is drawn into: a float target, its samples, the display.

Draws go into a linear float target, multisampled or not. The display pass
averages its samples, in linear radiance, and tone maps once; who wants the
radiance itself has it resolved into a target that exists only then.
"""

from functools import cached_property

from moka.commands.descriptors import (
    Attachment,
    FramebufferDescriptor,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = ["Targets"]


class Targets:
    """The framebuffers of one size (width, height) and sample count.

    ``scene`` is drawn into, ``scene_texture`` and ``depth_texture`` are what
    it holds, ``display`` gets tone mapped bytes, ``resolved`` one radiance
    per pixel. Half floats hold radiance up to 65 504, which the display never
    needs; with ``float_output`` it is float32, for pictures whose values
    leave as numbers. Each is made when it is first asked for: by then images
    are decoded, and it takes the memory that they needed.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        size: tuple[int, int],
        samples: int,
        *,
        float_output: bool,
    ) -> None:
        self.made_for = (size, samples, float_output)
        self._device = device
        self._resources: list[Handle] = []
        self._format = (
            PixelFormat.RGBA32F if float_output else PixelFormat.RGBA16F
        )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.made_for[0]

    @property
    def samples(self) -> int:
        """Samples of a pixel in ``scene``."""
        return self.made_for[1]

    @cached_property
    def scene_texture(self) -> Handle:
        """Linear radiance, premultiplied by coverage."""
        return self._texture(self._format, self.samples)

    @cached_property
    def depth_texture(self) -> Handle:
        """Depth of the same samples."""
        return self._texture(PixelFormat.DEPTH32F, self.samples)

    @cached_property
    def scene(self) -> Handle:
        """The framebuffer of both."""
        return self._framebuffer(self.scene_texture, self.depth_texture)

    @cached_property
    def display(self) -> Handle:
        """A framebuffer for bytes."""
        return self._framebuffer(self._display_texture)

    @cached_property
    def marked_display(self) -> Handle:
        """The same with the depth of ``scene``, which has one sample."""
        return self._framebuffer(self._display_texture, self.depth_texture)

    @cached_property
    def _display_texture(self) -> Handle:
        return self._texture(PixelFormat.RGBA8)

    @cached_property
    def resolved(self) -> Handle:
        """A framebuffer for one radiance per pixel."""
        return self._framebuffer(self._resolved_texture)

    @cached_property
    def marked_resolved(self) -> Handle:
        """The same with the depth of ``scene``, which has one sample."""
        return self._framebuffer(self._resolved_texture, self.depth_texture)

    @cached_property
    def _resolved_texture(self) -> Handle:
        return self._texture(self._format)

    def destroy(self) -> None:
        """Destroy all of it."""
        # Framebuffers before the textures that they draw into.
        self._device.destroy(*reversed(self._resources))
        self._resources.clear()

    def _texture(self, pixels: PixelFormat, samples: int = 1) -> Handle:
        return self._keep(
            self._device.create_texture(
                TextureDescriptor(
                    pixels,
                    *self.size,
                    samples=samples,
                    label=f"target {pixels.value}",
                )
            )
        )

    def _framebuffer(
        self, colour: Handle, depth: Handle | None = None
    ) -> Handle:
        return self._keep(
            self._device.create_framebuffer(
                FramebufferDescriptor(
                    (Attachment(colour),),
                    None if depth is None else Attachment(depth),
                )
            )
        )

    def _keep(self, handle: Handle) -> Handle:
        self._resources.append(handle)
        return handle
