"""Ten thousand cubes in a handful of draws.

    python examples/many_objects.py

Every cube is an object of its own, with a place and one of sixteen
materials. Draws that share a program are merged, so that OpenGL hears of a
few; what is outside the picture is not drawn at all.
"""

import math

import numpy as np

import moka
from moka.core.colour import decode_srgb
from moka.model import cube, model_of

SIDE = 100
MATERIALS = 16


def materials() -> list[moka.Material]:
    """Plastics around the colour wheel."""
    turns = np.arange(MATERIALS)[:, None] / MATERIALS + np.array([0, 1, 2]) / 3
    colours = decode_srgb(0.5 + 0.4 * np.cos(2 * np.pi * turns))
    return [
        moka.Material(
            base_colour_factor=(*colour, 1.0),
            metallic_factor=0.0,
            roughness_factor=0.35,
        )
        for colour in colours.tolist()
    ]


class ManyObjects(moka.App):
    """A field of cubes, as high as waves, and a camera that goes around."""

    def load(self) -> None:
        box = cube(0.8)
        palette = materials()
        items = []
        for row in range(SIDE):
            for column in range(SIDE):
                x, z = column - SIDE / 2, row - SIDE / 2
                wave = math.cos(0.15 * math.hypot(x, z))
                place = np.diag([1.0, 4.0 + 3.0 * wave, 1.0, 1.0])
                place[:3, 3] = x, 0.0, z
                material = palette[(row * 7 + column * 3) % MATERIALS]
                items.append((box, material, place))
        self.scene.add(model_of(items))
        self.scene.environment = moka.load_environment("studio")
        self.scene.background = "#e8e8ea"

    def update(self, time: moka.GameTime) -> None:
        width, height = self.size
        self.camera.frame(
            self.scene.bounds(),
            width / height,
            yaw=math.radians(37) + 0.2 * time.total,
            pitch=math.radians(28),
            distance=95.0,
        )


def render(size: tuple[int, int] = (1280, 720)) -> moka.Image:
    """The first frame, made without a window."""
    return run(size).image


def run(size: tuple[int, int]) -> moka.App:
    """The app after one frame; its renderer has counted the work."""
    return moka.run(ManyObjects, headless=True, size=size)


if __name__ == "__main__":
    moka.run(ManyObjects)
