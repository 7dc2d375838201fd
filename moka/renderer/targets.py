"""What a frame is drawn into: a float target, its samples, the display.

Draws go into a linear float target, multisampled or not; samples are
averaged there, in linear radiance; tone mapping comes last and once.
"""

from msgspec import Struct

from moka.commands.descriptors import (
    Attachment,
    FramebufferDescriptor,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice

__all__ = ["Targets", "make_targets"]


class Targets(Struct, frozen=True):
    """The framebuffers of one size, sample count and float output.

    ``scene`` is drawn into, ``resolved`` holds one radiance per pixel (the
    same framebuffer without multisampling), ``display`` tone mapped bytes.
    """

    made_for: tuple[tuple[int, int], int, bool]
    scene: Handle
    scene_texture: Handle
    resolved: Handle
    resolved_texture: Handle
    display: Handle
    resources: tuple[Handle, ...]

    @property
    def samples(self) -> int:
        """Samples of a pixel in ``scene``; more than 1 must be resolved."""
        return self.made_for[1]

    def destroy(self, device: GraphicsDevice) -> None:
        """Destroy all of it."""
        device.destroy(*self.resources)


def make_targets(
    device: GraphicsDevice,
    size: tuple[int, int],
    samples: int,
    *,
    float_output: bool,
) -> Targets:
    """Targets of ``size`` (width, height).

    Half floats hold radiance up to 65 504, which the display never needs;
    float32 is for pictures whose values leave as numbers.
    """
    colour_format = PixelFormat.RGBA32F if float_output else PixelFormat.RGBA16F
    resources: list[Handle] = []

    def texture(pixels: PixelFormat, count: int = 1) -> Handle:
        handle = device.create_texture(
            TextureDescriptor(
                pixels, *size, samples=count, label=f"target {pixels.value}"
            )
        )
        resources.append(handle)
        return handle

    def framebuffer(colour: Handle, depth: Handle | None = None) -> Handle:
        handle = device.create_framebuffer(
            FramebufferDescriptor(
                (Attachment(colour),),
                None if depth is None else Attachment(depth),
            )
        )
        resources.append(handle)
        return handle

    resolved_texture = texture(colour_format)
    depth = texture(PixelFormat.DEPTH32F, samples)
    scene_texture = resolved_texture
    if samples > 1:
        scene_texture = texture(colour_format, samples)
        scene = framebuffer(scene_texture, depth)
        resolved = framebuffer(resolved_texture)
    else:
        scene = resolved = framebuffer(resolved_texture, depth)
    display = framebuffer(texture(PixelFormat.RGBA8))
    return Targets(
        (size, samples, float_output),
        scene,
        scene_texture,
        resolved,
        resolved_texture,
        display,
        # Framebuffers before the textures that they draw into.
        tuple(reversed(resources)),
    )
