"""A grid of spheres made in memory, without a file.

    python examples/material_grid.py

Roughness grows to the right from mirror to matt, metalness grows upwards
from plastic to metal; the base colour is the same everywhere.
"""

import numpy as np

import moka
from moka.model import Orthographic, model_of, sphere

COLUMNS = 7
ROWS = 4
ORANGE = (0.8, 0.3, 0.08, 1.0)


def material(row: int, column: int) -> moka.Material:
    """The material of one sphere; row 0 is the lowest."""
    return moka.Material(
        base_colour_factor=ORANGE,
        metallic_factor=row / (ROWS - 1),
        roughness_factor=column / (COLUMNS - 1),
    )


def model() -> moka.Model:
    """The spheres, 1 m apart; all share one mesh's arrays."""
    ball = sphere(0.45, segments=64, rings=32)
    items = []
    for row in range(ROWS):
        for column in range(COLUMNS):
            place = np.eye(4)
            place[:2, 3] = column, row
            items.append((ball, material(row, column), place))
    return model_of(items, name="material grid")


def camera() -> moka.Camera:
    """Looks at the grid from the front, along -Z."""
    lens = Orthographic(xmag=3.6, ymag=2.1, near=0.1, far=10.0)
    result = moka.Camera(lens)
    result.transform.position = (COLUMNS - 1) / 2, (ROWS - 1) / 2, 5.0
    return result


def render(size: tuple[int, int] = (1280, 760)) -> moka.Image:
    """The picture of the grid, seen from the front."""
    return moka.render(
        model(),
        environment="studio",
        background="#1c1c1e",
        camera=camera(),
        size=size,
    )


if __name__ == "__main__":
    render().save("material_grid.png")
