"""Pictures for a network to learn from, with the truth beside them.

    python examples/dataset.py [MODEL.gltf [FOLDER]]

From random places around a model: radiance, and in the same .exr file depth,
normals, albedo and which object each pixel belongs to. Nothing here needs a
display, so that it runs where there is none.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import moka

AOVS = ("depth", "normal", "albedo", "object-id")


def views(count: int, seed: int = 0) -> Iterator[str]:
    """Cameras that are spread evenly over the upper half of a sphere."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        yaw = random.uniform(-180.0, 180.0)
        # Equal areas of a sphere have equal heights (Archimedes).
        pitch = np.degrees(np.arcsin(random.uniform(0.05, 0.95)))
        yield f"orbit:{yaw:.3f},{pitch:.3f}"


def pictures(
    model: str | None, count: int, size: tuple[int, int]
) -> Iterator[moka.Image]:
    """Pictures with their layers."""
    loaded = moka.load_model(model) if model else None
    for camera in views(count):
        yield moka.render(
            loaded, camera=camera, size=size, environment="studio", aov=AOVS
        )


def write(folder: Path, model: str | None = None, count: int = 8) -> None:
    """Write ``count`` files 0000.exr, 0001.exr and so on."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, image in enumerate(pictures(model, count, (640, 480))):
        image.save(folder / f"{number:04}.exr")


def render(size: tuple[int, int] = (1280, 720)) -> moka.Image:
    """Radiance, normals, depth and objects of one view, in four quarters."""
    width, height = size[0] // 2, size[1] // 2
    (image,) = pictures(None, 1, (width, height))
    layers = image.layers
    hit = layers["object-id"][..., None] > 0
    normal = np.where(hit, 0.5 + 0.5 * layers["normal"], 0.0)
    nearest = layers["depth"].min()
    depth = np.repeat(nearest / layers["depth"][..., None], 3, axis=2)
    colours = np.random.default_rng(1).random((256, 3))
    objects = np.where(hit, colours[layers["object-id"] % 256], 0.0)
    quarters = [
        np.hstack([image.pixels[..., :3], normal]),
        np.hstack([depth, objects]),
    ]
    pixels = np.ones((2 * height, 2 * width, 4), np.float32)
    pixels[..., :3] = np.vstack(quarters)
    return moka.Image(pixels)


if __name__ == "__main__":
    given = sys.argv[1:]
    write(Path(given[1] if len(given) > 1 else "dataset"), *given[:1])
