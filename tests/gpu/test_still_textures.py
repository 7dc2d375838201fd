"""A still picture is the same without what it cannot show of its textures."""

from pathlib import Path

import numpy as np
import pytest

import moka
from moka.app.render import render_request
from moka.app.render_request import RenderRequest
from moka.commands.command_list import CommandList
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.material.material import Material, Texture
from moka.model import model_of, quad, sphere
from moka.renderer.material_pool import MaterialPool
from moka.renderer.renderer import Renderer
from moka.renderer.texture_settings import TextureSettings
from tests.support.pictures import encoded, placed_at, scene_of, square_camera

pytestmark = pytest.mark.gpu

HERE = np.eye(4)


def noise(side: int) -> EncodedImage:
    """Texels of all frequencies."""
    random = np.random.default_rng(8)
    return encoded(random.integers(0, 256, (side, side, 3)))


def drawn(
    model: object, size: tuple[int, int], *, full: bool, **options: object
) -> tuple[np.ndarray, dict[str, int]]:
    """Display bytes and the counters."""
    statistics = Statistics()
    request = RenderRequest(
        model, size=size, full_textures=full, backend="egl", **options
    )
    image = render_request(
        request, statistics, want_pixels=False, want_display=True
    )
    return image.to_display()[:, :, :3].astype(int), statistics.counts


def check_difference(one: np.ndarray, other: np.ndarray) -> None:
    """Below 1/255 on average and 2/255 in 999 of 1000 pixels."""
    difference = np.abs(one - other)
    assert difference.mean() < 1
    assert np.percentile(difference.max(axis=2), 99.9) <= 2


@pytest.mark.parametrize("shape", [quad(1.0), sphere(0.5)])
@pytest.mark.parametrize("camera", ["orbit:0,0", "orbit:35,25"])
def test_levels_that_are_too_fine_are_left_out(
    shape: moka.model.Primitive, camera: str
) -> None:
    """Of noise, where each level looks different."""
    texture = Texture(noise(1024))
    material = Material(base_colour_texture=texture, unlit=True)
    model = model_of([(shape, material, HERE)])
    options = {"camera": camera, "environment": "none"}
    full, counts = drawn(model, (96, 96), full=True, **options)
    assert counts["textures_reduced"] == 0
    few, fewer = drawn(model, (96, 96), full=False, **options)
    assert fewer["textures_reduced"] == 1
    assert fewer["bytes_uploaded"] < 0.3 * counts["bytes_uploaded"]
    check_difference(few, full)
    # As much as the picture shows, and no less.
    assert few.std() > 2


def test_images_that_no_visible_object_samples_are_not_opened(
    tmp_path: Path,
) -> None:
    """There is no such file, and nobody asks for it."""
    gone = EncodedImage("gone.png", path=tmp_path / "gone.png")
    hidden = Material(base_colour_texture=Texture(gone))
    seen = Material(base_colour_texture=Texture(noise(8)), unlit=True)
    items = [
        (quad(1.0), seen, HERE),
        (quad(1.0), hidden, placed_at(z=50.0)),
    ]
    camera = square_camera()
    picture = moka.render(
        model_of(items), camera=camera, size=(16, 16), environment="none"
    )
    assert picture.pixels[8, 8, :3].max() > 0
    with pytest.raises(ImageFileError, match=r"gone\.png"):
        moka.render(
            model_of(items), camera=camera, size=(16, 16), full_textures=True
        )


def test_another_picture_gets_what_the_first_did_without(
    egl_device: GraphicsDevice,
) -> None:
    """As after a step towards the texture."""
    material = Material(base_colour_texture=Texture(noise(512)), unlit=True)
    scene = scene_of([(quad(1.0), material, HERE)])
    far, near = square_camera(8.0), square_camera(0.05)
    pictures = []
    for first, levels in ((far, 1), (near, 0)):
        statistics = Statistics()
        materials = MaterialPool(egl_device, statistics)
        scene.update()
        materials.begin(scene, first, (64, 64), TextureSettings())
        renderer = Renderer(
            egl_device, (64, 64), statistics=statistics, materials=materials
        )
        for camera in (first, near):
            commands = CommandList()
            renderer.draw(scene, camera, commands)
            read = renderer.read_display(commands)
            egl_device.submit(commands).wait()
        renderer.close()
        pictures.append(read.data)
        assert statistics.counts["textures_reduced"] == levels
    assert np.array_equal(*pictures)
    assert pictures[0].std() > 2


@pytest.mark.assets
@pytest.mark.parametrize(
    ("name", "side"),
    [
        ("DamagedHelmet/DamagedHelmet.gltf", 256),
        ("BoomBox/BoomBox.gltf", 384),
        ("CesiumMilkTruck.glb", 160),
    ],
)
def test_real_models_look_the_same(assets: Path, name: str, side: int) -> None:
    path = assets / "models" / name
    full, _ = drawn(path, (side, side), full=True)
    few, counts = drawn(path, (side, side), full=False)
    assert counts["textures_reduced"] > 0
    check_difference(few, full)
