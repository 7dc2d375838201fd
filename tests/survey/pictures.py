"""Small pictures for surveys: flat, each of its own colour."""

from pathlib import Path

import numpy as np

from moka.core.png import write_png

RENDERERS = ("frostbite", "moka", "unity")
SCENES = ("bottle", "helmet")


def write_pictures(folder: Path) -> list[Path]:
    """``SCENE@RENDERER.png`` for every scene and renderer, 48 x 32."""
    folder.mkdir()
    paths = []
    for row, scene in enumerate(SCENES):
        for column, renderer in enumerate(RENDERERS):
            path = folder / f"{scene}@{renderer}.png"
            colour = np.array([60 * column, 90 * row + 20, 128], np.uint8)
            write_png(path, np.broadcast_to(colour, (32, 48, 3)))
            paths.append(path)
    return paths
