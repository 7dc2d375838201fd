"""Flat patches, each of one normal and one material, seen in parallel.

All pixels of a patch have the same answer, so that it can be compared with
an oracle without a word about pixels' footprints, and the spread of the
pixels is the noise.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model.assemble import model_of
from moka.model.cameras import Orthographic
from moka.model.mesh import Primitive
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.oracles import reference as oracle
from tests.support.pictures import draw_radiance

Array = NDArray[np.float64]

VIEW = np.array([0.0, 0.0, 1.0])
EDGE = 8  # pixels of a patch


def tilted(cosines: Sequence[float], azimuth: float = 0.7) -> Array:
    """Normals (N, 3) at these n.v, leaning all ways."""
    cosine = np.asarray(cosines)
    turn = azimuth + 2.4 * np.arange(len(cosine))
    sine = np.sqrt(1.0 - cosine**2)
    return np.stack((sine * np.cos(turn), sine * np.sin(turn), cosine), axis=-1)


def sunny(height: int = 32, sun: float = 3e3) -> NDArray[np.float32]:
    """A sky with a gradient, blocks of colour, and a sun of one texel."""
    generator = np.random.default_rng(5)
    blocks = generator.uniform(0.1, 1.2, (height // 4, height // 2, 3))
    pixels = blocks.repeat(4, axis=0).repeat(4, axis=1)
    pixels *= np.linspace(1.5, 0.3, height)[:, None, None]
    if sun:
        # In front of the surfaces: +Z is at u = 3/4.
        pixels[height * 3 // 10, height * 17 // 12] = (
            np.array([1, 0.9, 0.7]) * sun
        )
    return pixels.astype(np.float32)


def draw_patches(
    device: GraphicsDevice,
    environment: Environment | None,
    normals: Array,
    materials: Sequence[oracle.Material],
    *,
    environment_rotation: float = 0.0,
    environment_intensity: float = 1.0,
    lights: Any = (),
    **settings: object,
) -> NDArray[np.float32]:
    """Radiance (materials, normals, pixels, 3), seen from +Z.

    Without the pixels along edges: a jittered view can round across them.
    """
    rows, columns = len(materials), len(normals)
    items = []
    for row, material in enumerate(materials):
        described = Material(
            base_colour_factor=(*material.colour, 1.0),
            metallic_factor=material.metalness,
            roughness_factor=material.roughness,
            ior=material.ior,
            specular_factor=material.specular,
            specular_colour_factor=material.specular_colour,
        )
        items += [
            (_patch(column, rows - 1 - row, normal), described, np.eye(4))
            for column, normal in enumerate(normals)
        ]
    scene = Scene()
    scene.environment = environment
    scene.environment_rotation = environment_rotation
    scene.environment_intensity = environment_intensity
    scene.background = "transparent"
    scene.add(model_of(items, lights=lights))
    camera = Camera(Orthographic(columns / 2, rows / 2, 0.01, 10.0))
    camera.transform.translate((columns / 2, rows / 2, 5.0))
    size = (columns * EDGE, rows * EDGE)
    picture = draw_radiance(device, scene, camera, size, **settings)
    blocks = picture[..., :3].reshape(rows, EDGE, columns, EDGE, 3)
    inner = blocks.swapaxes(1, 2)[:, :, 1:-1, 1:-1]
    return inner.reshape(rows, columns, -1, 3)


def expected_patches(
    pixels: NDArray[np.float32],
    normals: Array,
    materials: Sequence[oracle.Material],
    *,
    multiscatter: bool = True,
) -> Array:
    """The oracle's radiance (materials, normals, 3)."""
    around = oracle.Surroundings(pixels)
    return np.array(
        [
            [
                oracle.reflected(
                    around, normal, VIEW, material, multiscatter=multiscatter
                )
                for normal in normals
            ]
            for material in materials
        ]
    )


def _patch(x: int, y: int, normal: Array) -> Primitive:
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]])
    positions = np.zeros((6, 3), np.float32)
    positions[:, :2] = corners + np.array([x, y])
    return Primitive({"POSITION": positions, "NORMAL": np.tile(normal, (6, 1))})
