"""A model that goes around, as a moving picture.

    python examples/turntable.py [MODEL.gltf [OUT.webp]]

The same as `moka render MODEL.gltf --turntable --frames 48 -o OUT.webp`.
The ending says what is written: .gif, .webp or .mp4. Each frame is drawn
while the one before is encoded.
"""

import sys

import moka
from moka.core.moving_picture import write_moving_picture

FRAMES = 48


def write(
    path: str,
    model: str | None = None,
    size: tuple[int, int] = (480, 360),
    frames: int = FRAMES,
) -> None:
    """Write the moving picture of a model, or of the built-in scene."""
    images = moka.render_frames(
        model, frames=frames, turntable=True, size=size, environment="studio"
    )
    shown = (image.to_display() for image in images)
    write_moving_picture(path, shown, frames_per_second=24)


def render(size: tuple[int, int] = (960, 540)) -> moka.Image:
    """The frame a third of the way around."""
    frames = moka.render_frames(None, frames=3, turntable=True, size=size)
    _, image, _ = frames
    return image


if __name__ == "__main__":
    write(*(sys.argv[2:3] or ["turntable.webp"]), *sys.argv[1:2])
