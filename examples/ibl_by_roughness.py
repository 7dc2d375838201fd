"""Metal under a sky, lit in three ways: how far apart are they?

    python examples/ibl_by_roughness.py

From top to bottom: split-sum, which costs next to nothing; split-sum with 16
view-dependent samples a pixel; the environment integrated per pixel, the
truth that the others are measured against. Roughness grows to the right.
"""

import numpy as np

import moka
from moka.model import Orthographic, model_of, sphere

COLUMNS = 7
SILVER = (0.97, 0.96, 0.91, 1.0)
MODES = (
    {"ibl": "split-sum"},
    {"ibl": "filtered", "ibl_samples": 16},
    {"ibl": "reference", "reference_samples": 256},
)


def model() -> moka.Model:
    """Spheres of silver, 1 m apart, from mirror to matt."""
    ball = sphere(0.45, segments=64, rings=32)
    items = []
    for column in range(COLUMNS):
        silver = moka.Material(
            base_colour_factor=SILVER,
            roughness_factor=column / (COLUMNS - 1),
        )
        place = np.eye(4)
        place[0, 3] = column
        items.append((ball, silver, place))
    return model_of(items, name="spheres of silver")


def camera() -> moka.Camera:
    """Looks at the row from the front, along -Z."""
    lens = Orthographic(xmag=3.5, ymag=0.7, near=0.1, far=10.0)
    result = moka.Camera(lens)
    result.transform.position = ((COLUMNS - 1) / 2, 0.0, 5.0)
    return result


def rows(size: tuple[int, int]) -> list[moka.Image]:
    """One picture of the row for each mode."""
    return [
        moka.render(
            model(),
            environment="sky",
            background="#1c1c1e",
            camera=camera(),
            size=size,
            **mode,
        )
        for mode in MODES
    ]


def render(size: tuple[int, int] = (1120, 576)) -> moka.Image:
    """The rows, one above the other."""
    width, height = size
    pictures = rows((width, height // len(MODES)))
    return moka.Image(np.concatenate([image.pixels for image in pictures]))


if __name__ == "__main__":
    render().save("ibl_by_roughness.png")
