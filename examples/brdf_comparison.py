"""One row of metal spheres, shaded by several reflection models.

    python examples/brdf_comparison.py

From top to bottom:

* glTF 2.0 with the energy that light keeps when it is scattered repeatedly;
* glTF 2.0 with single scattering only: rough metal turns dark;
* the separable Schlick-GGX of Karis 2013;
* Blinn-Phong, an empirical model.

Roughness grows to the right.
"""

import numpy as np

import moka
from moka.model import Orthographic, model_of, sphere

COLUMNS = 7
GOLD = (1.0, 0.766, 0.336, 1.0)
VARIANTS = (
    {"brdf": "gltf"},
    {"brdf": "gltf", "multiscatter": False},
    {"brdf": "karis", "multiscatter": False},
    {"brdf": "blinn-phong", "multiscatter": False},
)


def model() -> moka.Model:
    """Spheres of gold, 1 m apart, from mirror to matt."""
    ball = sphere(0.45, segments=64, rings=32)
    items = []
    for column in range(COLUMNS):
        gold = moka.Material(
            base_colour_factor=GOLD,
            roughness_factor=column / (COLUMNS - 1),
        )
        place = np.eye(4)
        place[0, 3] = column
        items.append((ball, gold, place))
    return model_of(items, name="spheres of gold")


def camera() -> moka.Camera:
    """Looks at the row from the front, along -Z."""
    lens = Orthographic(xmag=3.5, ymag=0.6, near=0.1, far=10.0)
    result = moka.Camera(lens)
    result.transform.position = ((COLUMNS - 1) / 2, 0.0, 5.0)
    return result


def rows(size: tuple[int, int]) -> list[moka.Image]:
    """One picture of ``size`` for each variant."""
    spheres = model()
    return [
        moka.render(
            spheres,
            environment="sky",
            background="#1c1c1e",
            camera=camera(),
            size=size,
            **variant,
        )
        for variant in VARIANTS
    ]


def render(size: tuple[int, int] = (1280, 880)) -> moka.Image:
    """The rows one below the other."""
    width, height = size
    strips = rows((width, height // len(VARIANTS)))
    return moka.Image(np.concatenate([strip.pixels for strip in strips]))


if __name__ == "__main__":
    render().save("brdf_comparison.png")
