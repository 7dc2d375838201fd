"""Scenes that grow in one respect: objects, materials, lights, texels.

The cubes are those of ``tests/benchmarks/bare_cubes.py``, which draws them
by hand with one instanced draw: the floor for what is measured here.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from moka.bench.steady import Orbit
from moka.core.encoded_image import EncodedImage
from moka.core.maths import look_rotation
from moka.core.png import encode_png
from moka.core.resources import asset_folder
from moka.lighting.environment import load_environment
from moka.material.material import Material, Texture
from moka.model.assemble import model_of
from moka.model.geometry import cube, sphere
from moka.model.lights import LightKind, PunctualLight
from moka.model.load import load_model
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = [
    "Subject",
    "of_lights",
    "of_materials",
    "of_objects",
    "of_pixels",
    "of_textures",
    "of_visible",
]

MATERIALS = 16
_STEP = 0.01  # radians a frame
_TO_SUN = np.array((0.48, 0.8, 0.36))

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Subject:
    """What is drawn: ``advance`` moves the camera for a frame's number."""

    scene: Scene
    camera: Camera
    advance: Callable[[int], None]
    size: tuple[int, int]
    samples: int = 1


def of_objects(count: int) -> Subject:
    """``count`` cubes, turned at random, of sixteen materials, 256 x 256.

    A directional light and no environment.
    """
    scene, camera, orbit = _cubes(count, MATERIALS)
    return Subject(scene, camera, orbit, (256, 256))


def of_materials(count: int, objects: int = 1000) -> Subject:
    """``objects`` cubes as in :func:`of_objects`, of ``count`` materials."""
    scene, camera, orbit = _cubes(objects, count)
    return Subject(scene, camera, orbit, (256, 256))


def of_visible(percent: int, objects: int = 10_000) -> Subject:
    """``objects`` cubes of which the camera sees 100 or 50 ``percent``.

    For the half of them their centre lies on the edge of the picture.
    """
    scene, camera, orbit = _cubes(objects, MATERIALS)
    aside = (100 - percent) / 50.0

    def advance(frame: int) -> None:
        orbit(frame)
        world = camera.transform.world_matrix.copy()
        edge = orbit.distance * math.tan(math.radians(45.0) / 2.0)
        world[:3, 3] += aside * edge * world[:3, 0]
        camera.transform.world_matrix = world

    return Subject(scene, camera, advance, (256, 256))


def of_lights(count: int) -> Subject:
    """64 spheres under ``count`` point lights, 256 x 256."""
    random = np.random.default_rng(3)
    shape = sphere()
    material = Material(metallic_factor=0.0, roughness_factor=0.4)
    places = _lattice(64) * 1.5
    scene = Scene()
    scene.add(model_of([(shape, material, _moved(each)) for each in places]))
    for direction in random.normal(size=(count, 3)):
        place = 6.0 * direction / np.linalg.norm(direction)
        light = PunctualLight(LightKind.POINT, intensity=200.0 / count)
        scene.add_light(light, _moved(place))
    camera = Camera()
    return Subject(scene, camera, Orbit(scene, camera, 1.0, _STEP), (256, 256))


def of_pixels(side: int) -> Subject:
    """The built-in scene in the studio, ``side`` pixels wide and high."""
    scene = Scene()
    scene.add(load_model(asset_folder() / "demo.glb"))
    scene.environment = load_environment("studio")
    camera = Camera()
    orbit = Orbit(scene, camera, 1.0, _STEP)
    return Subject(scene, camera, orbit, (side, side), samples=4)


def of_textures(side: int) -> Subject:
    """A sphere with four textures of ``side`` texels, 512 x 512."""
    colour, normal, surface, glow = (
        Texture(EncodedImage(f"pattern {number}", data=_pattern(side, number)))
        for number in range(4)
    )
    material = Material(
        base_colour_texture=colour,
        normal_texture=normal,
        metallic_roughness_texture=surface,
        emissive_texture=glow,
        emissive_factor=(0.1, 0.1, 0.1),
    )
    scene = Scene()
    scene.add(model_of([(sphere(), material, np.eye(4))]))
    scene.add_light(PunctualLight(LightKind.DIRECTIONAL, intensity=3.0))
    camera = Camera()
    return Subject(scene, camera, Orbit(scene, camera, 1.0, _STEP), (512, 512))


class _Distant:
    """An orbit at a given height and distance around the origin."""

    def __init__(self, camera: Camera, extent: float) -> None:
        self._camera = camera
        self._box = np.array([[-extent] * 3, [extent] * 3])
        self._pitch = math.atan(0.5)
        self.distance = 4.1 * extent * math.hypot(1.0, 0.5)

    def __call__(self, frame: int) -> None:
        """Place the camera for ``frame``."""
        self._camera.frame(
            self._box, 1.0, frame * _STEP, self._pitch, self.distance
        )


def _cubes(count: int, materials: int) -> tuple[Scene, Camera, _Distant]:
    random = np.random.default_rng(2)
    values = random.random((materials, 8))
    looks = [
        Material(
            name=f"material {number}",
            base_colour_factor=(float(red), float(green), float(blue), 1.0),
            metallic_factor=float(metal > 0.5),
            roughness_factor=0.1 + 0.9 * float(rough),
        )
        for number, (red, green, blue, metal, rough, *_) in enumerate(values)
    ]
    turns = np.random.default_rng(1).normal(size=(count, 4))
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, :3] = 0.5 * _rotations(turns)
    matrices[:, :3, 3] = _lattice(count)
    shape = cube()
    scene = Scene()
    scene.add(
        model_of(
            (shape, looks[number % materials], matrix)
            for number, matrix in enumerate(matrices)
        )
    )
    scene.background = (0.02, 0.02, 0.03)
    lamp = np.eye(4)
    lamp[:3, :3] = look_rotation(-_TO_SUN, (0, 1, 0))
    scene.add_light(PunctualLight(LightKind.DIRECTIONAL, intensity=3.0), lamp)
    camera = Camera()
    return scene, camera, _Distant(camera, _side(count) / 2)


def _side(count: int) -> int:
    """Cubes along the edge of the lattice of ``count``."""
    return math.ceil(round(float(np.cbrt(count)), 9))


def _lattice(count: int) -> Array:
    """``count`` places (N, 3) of a cubic lattice around the origin."""
    side = _side(count)
    places = np.stack(np.unravel_index(np.arange(count), (side,) * 3), -1)
    return np.asarray(places, np.float64) - (side - 1) / 2


def _rotations(quaternions: Array) -> Array:
    """Matrices (N, 3, 3) of quaternions (N, 4) of any length, w first."""
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    w, x, y, z = (quaternions / length).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrices: Array = np.moveaxis(np.array(rows), -1, 0)
    return matrices


def _moved(place: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, 3] = place
    return matrix


def _pattern(side: int, number: int) -> bytes:
    """A PNG of no one colour that is quick to encode."""
    row = np.arange(side, dtype=np.uint32)
    blocks = (row[:, None] // 8 * (number + 3)) ^ (row // 8)
    texels = np.empty((side, side, 3), np.uint8)
    texels[:] = (128 + blocks % 64)[:, :, None]
    texels[:, :, 2] = 255 - blocks % 128
    return encode_png(texels)
