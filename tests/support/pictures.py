"""Pictures of small scenes, for tests that read radiance back."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.commands.command_list import CommandList
from moka.core.encoded_image import EncodedImage
from moka.core.png import encode_png
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model.assemble import model_of
from moka.model.cameras import Orthographic, Perspective
from moka.model.mesh import Primitive
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = [
    "draw_radiance",
    "draw_with_display",
    "encoded",
    "looking",
    "placed_at",
    "scene_of",
    "square_camera",
]

Items = list[tuple[Primitive, Material | None, ArrayLike]]


def placed_at(x: float = 0, y: float = 0, z: float = 0) -> NDArray[Any]:
    """A translation (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def scene_of(
    items: Items,
    environment: Environment | None = None,
    background: Any = "environment",
    lights: Any = (),
) -> Scene:
    """A scene of primitives, materials and matrices."""
    scene = Scene()
    scene.environment = environment
    scene.background = background
    scene.add(model_of(items, lights=lights))
    return scene


def square_camera(half: float = 1.0, distance: float = 5.0) -> Camera:
    """Looks along -Z at the square from -half to half, in parallel."""
    camera = Camera(Orthographic(half, half, 0.01, 100.0))
    camera.transform.translate((0, 0, distance))
    return camera


def looking(
    towards: ArrayLike,
    fov: float = math.radians(10),
    eye: ArrayLike = (0, 0, 0),
) -> Camera:
    """A narrow view from ``eye`` in a direction."""
    camera = Camera(Perspective(fov))
    eye = np.asarray(eye, np.float64)
    camera.transform.translate(tuple(eye))
    target = eye + np.asarray(towards, np.float64)
    up = (0, 1, 0) if abs(np.asarray(towards)[1]) < 0.9 else (0, 0, 1)
    camera.transform.look_at(tuple(target), up)
    return camera


def draw_radiance(
    device: GraphicsDevice,
    scene: Scene,
    camera: Camera,
    size: tuple[int, int] = (32, 32),
    **settings: Any,
) -> NDArray[np.float32]:
    """Linear radiance (H, W, 4), top row first."""
    return draw_with_display(device, scene, camera, size, **settings)[0]


def draw_with_display(
    device: GraphicsDevice,
    scene: Scene,
    camera: Camera,
    size: tuple[int, int] = (32, 32),
    **settings: Any,
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Linear radiance and display bytes (H, W, 4), top row first."""
    options = {"samples": 1, "float_output": True} | settings
    renderer = Renderer(device, size, RenderSettings(**options))
    try:
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        while not renderer.is_complete:
            device.submit(commands).wait()
            commands = CommandList()
            renderer.draw(scene, camera, commands)
        radiance = renderer.read_radiance(commands)
        display = renderer.read_display(commands)
        device.submit(commands).wait()
    finally:
        renderer.close()
    assert radiance.data is not None
    assert display.data is not None
    return radiance.data[::-1], display.data[::-1]


def encoded(texels: ArrayLike, where: str = "test image") -> EncodedImage:
    """A PNG in memory of uint8 texels (H, W, C)."""
    data = encode_png(np.asarray(texels, np.uint8))
    return EncodedImage(where, data=data)
