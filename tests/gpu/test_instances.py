"""Instances, hidden nodes and variants: pictures of files that have them."""

import base64

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from moka.app.render import RenderRequest, render_request
from moka.commands.command_list import CommandList
from moka.core.png import encode_png
from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.model import load_model
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from moka.scene.transform import Transform
from tests.support.gltf_file import GltfFile
from tests.support.pictures import draw_radiance, square_camera

pytestmark = pytest.mark.gpu


def scene_of_file(file: GltfFile, **choice: object) -> Scene:
    scene = Scene()
    scene.background = (0.0, 0.0, 0.0)
    scene.add(load_model(file.glb()), **choice)
    return scene


def test_instances_draw_what_as_many_nodes_draw(
    egl_device: GraphicsDevice,
) -> None:
    random = np.random.default_rng(3)
    count = 100
    places = random.uniform(-1, 1, (count, 3)).astype(np.float32)
    turns = Rotation.random(count, random_state=3).as_quat().astype("f4")
    scales = random.uniform(0.05, 0.3, (count, 3)).astype(np.float32)
    pictures = []
    for instanced in (True, False):
        file = GltfFile()
        material = file.unlit(0.8, 0.4, 0.2, 1, doubleSided=True)
        mesh = file.quad(material=material)
        if instanced:
            attributes = {
                "TRANSLATION": file.accessor(places),
                "ROTATION": file.accessor(turns),
                "SCALE": file.accessor(scales),
            }
            file.node(
                mesh=mesh,
                rotation=[0, 0, 0.6, 0.8],
                extensions={
                    "EXT_mesh_gpu_instancing": {"attributes": attributes}
                },
            )
        else:
            file.node(rotation=[0, 0, 0.6, 0.8])
            file.document["nodes"][0]["children"] = [
                file.node(
                    mesh=mesh,
                    translation=place.tolist(),
                    rotation=turn.tolist(),
                    scale=scale.tolist(),
                )
                for place, turn, scale in zip(
                    places, turns, scales, strict=True
                )
            ]
        pictures.append(
            draw_radiance(egl_device, scene_of_file(file), square_camera())
        )
    assert pictures[0].any()
    assert np.array_equal(pictures[0], pictures[1])


def test_a_hidden_node_is_not_drawn(egl_device: GraphicsDevice) -> None:
    file = GltfFile()
    mesh = file.quad(4.0, material=file.unlit(1, 1, 1, 1))
    file.node(mesh=mesh, extensions={"KHR_node_visibility": {"visible": False}})
    scene = scene_of_file(file)
    assert not draw_radiance(egl_device, scene, square_camera()).any()


def variants() -> GltfFile:
    """A square that is red, and in variants green or blue."""
    file = GltfFile()
    for rgb in np.eye(3).tolist():
        file.unlit(*rgb, 1)
    mappings = [
        {"material": 1, "variants": [0]},
        {"material": 2, "variants": [1]},
    ]
    file.node(
        mesh=file.quad(
            4.0,
            material=0,
            extensions={"KHR_materials_variants": {"mappings": mappings}},
        )
    )
    file.document["extensions"] = {
        "KHR_materials_variants": {
            "variants": [{"name": "grass"}, {"name": "sky"}]
        }
    }
    return file


@pytest.mark.parametrize(
    ("variant", "colour"),
    [(None, (1, 0, 0)), ("grass", (0, 1, 0)), (1, (0, 0, 1))],
)
def test_a_variant_is_drawn_in_its_materials(
    egl_device: GraphicsDevice,
    variant: str | int | None,
    colour: tuple[int, int, int],
) -> None:
    scene = scene_of_file(variants(), variant=variant)
    picture = draw_radiance(egl_device, scene, square_camera())
    assert picture[16, 16, :3].tolist() == list(colour)


def test_variants_are_switched_without_new_geometry(
    egl_device: GraphicsDevice,
) -> None:
    scene = scene_of_file(variants())
    (model,) = scene.models
    renderer = Renderer(
        egl_device, (32, 32), RenderSettings(samples=1, float_output=True)
    )
    seen = []
    meshes = []
    try:
        for variant in (None, "sky", "grass", None):
            model.variant = variant
            assert model.variant == variant
            commands = CommandList()
            renderer.draw(scene, square_camera(), commands)
            read = renderer.read_radiance(commands)
            egl_device.submit(commands).wait()
            meshes.append(set(renderer._pools.geometry._meshes.values()))
            seen.append(read.data[16, 16, :3].tolist())
    finally:
        renderer.close()
    assert seen == [[1, 0, 0], [0, 0, 1], [0, 1, 0], [1, 0, 0]]
    assert all(each == meshes[0] for each in meshes)


def test_only_the_level_that_is_shown_is_drawn_and_decoded() -> None:
    """A picture of a file with levels is that of a file with one of them."""
    shades = [(250, 0, 0), (0, 250, 0), (0, 0, 250)]
    pictures = {}
    skipped = {}
    for only in (None, 0, 1, 2):
        for distance in (1.5, 4.0, 30.0):
            file = GltfFile()
            for shade in shades:
                textured(file, shade)
            meshes = [file.quad(material=index) for index in range(3)]
            if only is None:
                file.node(
                    mesh=meshes[0],
                    extensions={"MSFT_lod": {"ids": [1, 2]}},
                    extras={"MSFT_screencoverage": [0.3, 0.05, 0.0]},
                )
                file.node(mesh=meshes[1])
                file.node(mesh=meshes[2])
            else:
                file.node(mesh=meshes[only])
            request = RenderRequest(
                file.glb(),
                None,
                background=(0, 0, 0),
                camera=Camera(transform=Transform((0, 0, distance))),
                size=(32, 32),
                settings=RenderSettings(samples=1, float_output=True),
            )
            statistics = Statistics()
            image = render_request(
                request, statistics, want_pixels=True, want_display=False
            )
            pictures[only, distance] = image.pixels
            skipped[only, distance] = (
                statistics.counts["textures_loaded"],
                statistics.counts["textures_skipped"],
            )
    for level, distance in enumerate((1.5, 4.0, 30.0)):
        seen = pictures[None, distance]
        assert seen[:, :, level].any()
        assert np.array_equal(seen, pictures[level, distance])
        assert skipped[None, distance] == (1, 2)


def textured(file: GltfFile, shade: tuple[int, int, int]) -> None:
    """A material without light whose texture is of one colour."""
    data = encode_png(np.full((2, 2, 3), shade, np.uint8))
    uri = "data:image/png;base64," + base64.b64encode(data).decode()
    images = file.document.setdefault("images", [])
    images.append({"uri": uri})
    textures = file.document.setdefault("textures", [])
    textures.append({"source": len(images) - 1})
    material = file.unlit(1, 1, 1, 1)
    pbr = file.document["materials"][material]["pbrMetallicRoughness"]
    pbr["baseColorTexture"] = {"index": len(textures) - 1}


def test_a_hundred_thousand_instances_are_one_draw(
    egl_device: GraphicsDevice,
) -> None:
    """As many squares of a pixel, each with a place of its own."""
    side, shown = 320, 32
    count = side * side
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    # All over a picture, in front of one another.
    places = np.stack(
        [
            (column.ravel() % shown + 0.5) * 2 / shown - 1,
            (row.ravel() % shown + 0.5) * 2 / shown - 1,
            np.linspace(-1, 1, count),
        ],
        axis=1,
    )
    file = GltfFile()
    mesh = file.quad(2 / shown, material=file.unlit(1, 0.5, 0.25, 1))
    attributes = {"TRANSLATION": file.accessor(places)}
    file.node(
        mesh=mesh,
        extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    )
    scene = scene_of_file(file)
    renderer = Renderer(
        egl_device,
        (shown, shown),
        RenderSettings(samples=1, float_output=True),
    )
    try:
        commands = CommandList()
        renderer.draw(scene, square_camera(), commands)
        read = renderer.read_radiance(commands)
        counters = egl_device.submit(commands).wait()
    finally:
        renderer.close()
    assert renderer.statistics.counts["visible"] == count > 100_000
    # The squares, and the pass that shows the picture.
    assert counters.gl_draws == 2
    assert (read.data[:, :, :3] == (1, 0.5, 0.25)).all()
