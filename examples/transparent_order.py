"""Glass in front of glass, from both sides.

    python examples/transparent_order.py

What is blended has to be drawn from back to front. The order is part of each
draw's sort key, and so right from wherever one looks: the same panes seen
from the front and from behind.
"""

import numpy as np

import moka
from moka.material.material import AlphaMode
from moka.model import model_of, quad, sphere

COLOURS = ((0.9, 0.05, 0.02), (0.02, 0.6, 0.05), (0.02, 0.1, 0.9))


def model() -> moka.Model:
    """A white ball between panes of coloured glass."""
    items = []
    for index, colour in enumerate(COLOURS):
        glass = moka.Material(
            base_colour_factor=(*colour, 0.5),
            metallic_factor=0.0,
            roughness_factor=0.1,
            alpha_mode=AlphaMode.BLEND,
            double_sided=True,
        )
        place = np.eye(4)
        place[:3, 3] = 0.35 * (index - 1), 0.2 * (index - 1), index - 1
        items.append((quad(1.6), glass, place))
    ball = moka.Material(metallic_factor=0.0, roughness_factor=0.5)
    middle = np.eye(4)
    middle[2, 3] = -0.5
    items.append((sphere(0.4), ball, middle))
    return model_of(items, name="glass")


def render(size: tuple[int, int] = (1280, 480)) -> moka.Image:
    """The panes from the front and from behind, side by side."""
    width, height = size
    pictures = [
        moka.render(
            model(),
            environment="studio",
            background="#202024",
            camera=camera,
            size=(width // 2, height),
        )
        for camera in ("orbit:20,10", "orbit:200,10")
    ]
    return moka.Image(np.hstack([image.pixels for image in pictures]))


if __name__ == "__main__":
    render().save("transparent_order.png")
