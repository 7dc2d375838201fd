"""Small pictures for surveys, and people who rate them."""

import json
from pathlib import Path

import numpy as np

from moka.core.png import write_png

RENDERERS = ("frostbite", "moka", "unity")
SCENES = ("bottle", "helmet")


def write_pictures(folder: Path) -> list[Path]:
    """``SCENE@RENDERER.png`` for every scene and renderer, 48 x 32.

    Each is flat and of its own colour.
    """
    folder.mkdir()
    paths = []
    for row, scene in enumerate(SCENES):
        for column, renderer in enumerate(RENDERERS):
            path = folder / f"{scene}@{renderer}.png"
            colour = np.array([60 * column, 90 * row + 20, 128], np.uint8)
            write_png(path, np.broadcast_to(colour, (32, 48, 3)))
            paths.append(path)
    return paths


def write_answers(key: Path, folder: Path, people: int = 3) -> None:
    """Let people take a survey: each rates higher than the one before."""
    known = json.loads(key.read_text("utf-8"))
    folder.mkdir(exist_ok=True)
    for person in range(people):
        ratings = [
            {"set": index, "picture": name, "rating": 3 + person + index % 2}
            for index, names in enumerate(known["sets"])
            for name in names
        ]
        answers = {
            "survey_answers": 1, "survey": known["survey"], "consent": True,
            "ratings": ratings,
        }  # fmt: skip
        (folder / f"{person}.json").write_text(json.dumps(answers))
