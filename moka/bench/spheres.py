"""Spheres of roughness × material, pixel by pixel, for errors and times.

Errors are taken from *facets*: every pixel of a sphere is a flat square with
the normal that the sphere has at the pixel's centre, seen in parallel. Then
all of a pixel has one answer, whichever point of it is sampled, and a
difference between two pictures is one of lighting and of nothing else. Gaps
between the squares are wider than rasterisation is inexact, so that no
sample of a pixel sees its neighbour; what falls into a gap is transparent.
Times are taken from smooth spheres in the same places.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from moka.material.material import Material
from moka.model.assemble import model_of
from moka.model.cameras import Orthographic
from moka.model.geometry import sphere
from moka.model.mesh import Primitive
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["MATERIALS", "SphereGrid", "Substance"]

Array = NDArray[np.float64]

# Pixels; drivers place vertices to 1/256 of one.
_GAP = 1 / 32


@dataclass(frozen=True, slots=True)
class Substance:
    """All of a material but its roughness; ``colour`` is linear Rec.709."""

    name: str
    colour: tuple[float, float, float]
    metalness: float


#: Metalness × F0. A black dielectric is its interface alone, F0 is 0.04; a
#: metal's F0 is its colour.
MATERIALS = (
    Substance("black dielectric", (0.0, 0.0, 0.0), 0.0),
    Substance("clay", (0.8, 0.3, 0.2), 0.0),
    Substance("half metal", (0.8, 0.3, 0.2), 0.5),
    Substance("iron", (0.56, 0.57, 0.58), 1.0),
    Substance("gold", (1.0, 0.77, 0.34), 1.0),
)


class SphereGrid:
    """A sphere for each substance (rows) and roughness (columns).

    Each is ``diameter`` pixels wide, an even number. ``size`` is the
    picture's width and height.
    """

    def __init__(
        self,
        substances: tuple[Substance, ...],
        roughnesses: tuple[float, ...],
        diameter: int,
    ) -> None:
        self.substances = substances
        self.roughnesses = roughnesses
        self.diameter = diameter
        self.size = len(roughnesses) * diameter, len(substances) * diameter
        self._normals = _normals(diameter)

    def facets(self) -> Scene:
        """The spheres as one square a pixel."""
        return self._scene(_facets(self._normals, self.diameter))

    def smooth(self) -> Scene:
        """The spheres as meshes."""
        return self._scene(sphere(self.diameter / 2, 48, 24))

    def camera(self) -> Camera:
        """Sees one metre as one pixel, in parallel along -Z."""
        width, height = self.size
        reach = float(self.diameter)
        camera = Camera(
            Orthographic(width / 2, height / 2, 0.5 * reach, 2.0 * reach)
        )
        camera.transform.translate((width / 2, height / 2, 1.25 * reach))
        return camera

    def pixels(self, picture: NDArray[np.float32]) -> NDArray[np.float32]:
        """Those on spheres of a picture (H, W, C) whose top row is first.

        The result is (substances, roughnesses, P, C).
        """
        edge = self.diameter
        rows, columns = len(self.substances), len(self.roughnesses)
        blocks = picture.reshape(rows, edge, columns, edge, -1)
        inside = np.flipud(self._normals[:, :, 2] > 0.0)
        return blocks.swapaxes(1, 2)[:, :, inside]

    def _scene(self, shape: Primitive) -> Scene:
        items = []
        for row, substance in enumerate(reversed(self.substances)):
            for column, roughness in enumerate(self.roughnesses):
                material = Material(
                    name=f"{substance.name} {roughness:g}",
                    base_colour_factor=(*substance.colour, 1.0),
                    metallic_factor=substance.metalness,
                    roughness_factor=roughness,
                )
                place = np.eye(4)
                place[:2, 3] = np.add((column, row), 0.5) * self.diameter
                items.append((shape, material, place))
        scene = Scene()
        scene.background = "transparent"
        scene.add(model_of(items, name="spheres"))
        return scene


def _normals(diameter: int) -> Array:
    """(diameter, diameter, 3) at the pixels' centres, zero outside."""
    centre = (np.arange(diameter) + 0.5) / (diameter / 2) - 1.0
    x, y = np.meshgrid(centre, centre)
    squared = x * x + y * y
    z = np.sqrt(np.maximum(1.0 - squared, 0.0))
    return np.where(squared[..., None] < 1.0, np.stack([x, y, z], -1), 0.0)


def _facets(normals: Array, diameter: int) -> Primitive:
    rows, columns = np.nonzero(normals[:, :, 2] > 0.0)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    corners = _GAP / 2 + (1 - _GAP) * corners
    lower = np.stack([columns, rows], -1) - diameter // 2
    positions = np.zeros((len(rows), 4, 3))
    positions[:, :, :2] = lower[:, None] + corners
    first = 4 * np.arange(len(rows))[:, None]
    return Primitive(
        {
            "POSITION": positions.reshape(-1, 3),
            "NORMAL": normals[rows, columns].repeat(4, axis=0),
        },
        (first + np.array([0, 1, 2, 0, 2, 3])).reshape(-1),
    )
