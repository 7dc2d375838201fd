"""The demo scene: valid textures, all of it before its camera, cheap."""

import io
import time

import numpy as np
from PIL import Image

from moka.core.decode import decode_image
from moka.core.projection import perspective
from moka.core.resources import asset_folder
from moka.model import Perspective, demo_model, load_model
from moka.model.demo import _tile_images


def test_every_sphere_has_its_own_material() -> None:
    model = demo_model()
    _, meshes = model.instances()
    assert len(meshes) == 24
    assert len(model.materials) == 22
    roughness = [m.roughness_factor for m in model.materials[1:8]]
    np.testing.assert_allclose(roughness, np.linspace(0, 1, 7))


def test_the_file_that_ships_is_this_scene() -> None:
    """Made with ``save_model(demo_model(), "assets/demo.glb")``."""
    made, shipped = demo_model(), load_model(asset_folder() / "demo.glb")
    assert len(made.materials) == len(shipped.materials)
    for first, second in zip(made.materials, shipped.materials, strict=True):
        assert first.roughness_factor == second.roughness_factor
        assert np.allclose(first.base_colour_factor, second.base_colour_factor)
        for one, two in zip(first.textures, second.textures, strict=True):
            assert np.array_equal(
                decode_image(one.image), decode_image(two.image)
            )
    world = [m.nodes.world_matrices() for m in (made, shipped)]
    assert np.allclose(*world)
    for first, second in zip(made.meshes, shipped.meshes, strict=True):
        for one, two in zip(first.primitives, second.primitives, strict=True):
            assert one.attributes.keys() == two.attributes.keys()
            for name in one.attributes:
                assert np.array_equal(
                    one.attributes[name], two.attributes[name]
                )


def test_the_camera_sees_all_of_it() -> None:
    model = demo_model()
    (node,), (index,) = model.camera_instances()
    view = model.cameras[index].projection
    assert isinstance(view, Perspective)
    world = model.nodes.world_matrices()
    clip = perspective(view.yfov, 16 / 9, view.near, 100) @ np.linalg.inv(
        world[node]
    )
    for row, mesh in zip(*model.instances(), strict=True):
        for primitive in model.meshes[mesh].primitives:
            points = (
                np.c_[
                    primitive.attributes["POSITION"],
                    np.ones(primitive.vertex_count),
                ]
                @ (clip @ world[row]).T
            )
            assert (np.abs(points[:, :2]) < points[:, 3:]).all()


def test_textures_are_pictures_that_repeat() -> None:
    for data in _tile_images().values():
        with Image.open(io.BytesIO(data)) as image:
            image.load()
            assert (image.size, image.mode) == ((256, 256), "RGB")
            texels = np.asarray(image, np.int16)
        for axis in (0, 1):
            inside = np.abs(np.diff(texels, axis=axis)).max()
            seam = np.take(texels, 0, axis) - np.take(texels, -1, axis)
            assert np.abs(seam).max() <= inside + 2


def test_normals_have_unit_length_and_point_outwards() -> None:
    with Image.open(io.BytesIO(_tile_images()["normal"])) as image:
        normals = np.asarray(image, np.float64) / 127.5 - 1
    length = np.linalg.norm(normals, axis=-1)
    np.testing.assert_allclose(length, 1, atol=0.02)
    assert normals[..., 2].min() > 0.2
    # The upper edge of a tile leans upwards, its left edge to the left.
    assert normals[4, 64, 1] > 0.1
    assert normals[64, 4, 0] < -0.1


def test_it_is_built_quickly() -> None:
    _tile_images.cache_clear()
    start = time.process_time()
    demo_model()
    assert time.process_time() - start < 0.25
