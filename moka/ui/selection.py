"""Shows what is selected: the edges of its box, over the picture."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.scene.camera import Camera

__all__ = ["box_edges", "draw_box"]

_COLOUR = 0xFF40B0FF

# Pairs of corners that differ in one of three bits.
_EDGES = [
    (corner, corner | bit)
    for corner in range(8)
    for bit in (1, 2, 4)
    if not corner & bit
]


def draw_box(
    imgui: Any, box: ArrayLike, camera: Camera, area: tuple[int, int]
) -> None:
    """Draw the box (2, 3) seen by ``camera`` in a picture that fills ``area``.

    ``area`` is from the window's upper left corner, in its coordinates.
    """
    drawn = imgui.get_background_draw_list()
    drawn.push_clip_rect((0, 0), area)
    for start, end in box_edges(box, camera, area):
        drawn.add_line(start.tolist(), end.tolist(), _COLOUR, 1.5)
    drawn.pop_clip_rect()


def box_edges(
    box: ArrayLike, camera: Camera, area: tuple[int, int]
) -> NDArray[np.float64]:
    """The edges (E, 2, 2) of a box as lines of the window's coordinates.

    What is behind the camera is cut off.
    """
    corners = np.asarray(box, np.float64)
    width, height = area
    clip_from_world = (
        camera.projection_matrix(width / height, reversed_z=True)
        @ camera.view_matrix
    )
    points = np.array(
        [
            [corners[corner >> axis & 1, axis] for axis in range(3)] + [1.0]
            for corner in range(8)
        ]
    )
    clip = points @ clip_from_world.T
    lines = clip[np.array(_EDGES)]
    near = 1e-6
    lines = lines[(lines[:, :, 3] > near).any(axis=1)]
    # Where one end is behind: to where the line meets the plane w = near.
    for end in (0, 1):
        behind = lines[:, end, 3] <= near
        here, there = lines[behind, end], lines[behind, 1 - end]
        part = (near - here[:, 3]) / (there[:, 3] - here[:, 3])
        lines[behind, end] = here + part[:, None] * (there - here)
    unit = lines[:, :, :2] / lines[:, :, 3:]
    scale = np.array([0.5 * width, -0.5 * height])
    found: NDArray[np.float64] = (unit * scale) + (0.5 * width, 0.5 * height)
    return found
