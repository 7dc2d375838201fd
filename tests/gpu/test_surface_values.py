"""AOVs against what geometry and materials say."""

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import moka
from moka.core.aov import AOVS
from moka.core.exr import read_exr
from moka.material.material import AlphaMode, Material
from moka.model import model_of, quad, save_model
from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from tests.support.pictures import placed_at, square_camera

pytestmark = pytest.mark.gpu

SIZE = (24, 16)


def layers_of(items: Any, camera: Camera, *names: str) -> dict[str, Any]:
    image = moka.render(
        model_of(items),
        environment="none",
        size=SIZE,
        camera=camera,
        aov=names,
    )
    return image.layers


def turned(degrees: float) -> NDArray[np.float64]:
    """A rotation (4, 4) about +X."""
    matrix = np.eye(4)
    cosine, sine = (
        math.cos(math.radians(degrees)),
        math.sin(math.radians(degrees)),
    )
    matrix[1:3, 1:3] = [[cosine, -sine], [sine, cosine]]
    return matrix


@pytest.mark.parametrize("is_perspective", [True, False])
def test_depth_is_the_distance_along_the_axis(is_perspective: bool) -> None:
    """Of a tilted plane: rays of each pixel's centre against the plane."""
    width, height = SIZE
    aspect = width / height
    lens = (
        Perspective(math.radians(50), None, 0.1, 100.0)
        if is_perspective
        else Orthographic(1.2 * aspect, 1.2, 0.1, 100.0)
    )
    camera = Camera(lens)
    camera.transform.translate((0, 0, 3))
    items = [(quad(100.0), Material(), turned(-40))]
    depth = layers_of(items, camera, "depth")["depth"]

    x = (np.arange(width) + 0.5) / width * 2 - 1
    y = 1 - (np.arange(height) + 0.5) / height * 2
    x, y = np.meshgrid(x, y)
    # The plane through the origin: y n_y + z n_z = 0.
    normal = turned(-40)[:3, 2]
    if is_perspective:
        slope = y * math.tan(math.radians(25))
        # (slope d) n_y + (3 - d) n_z = 0
        expected = 3 * normal[2] / (normal[2] - slope * normal[1])
    else:
        expected = 3 + 1.2 * y * normal[1] / normal[2]
    assert depth.shape == (height, width)
    assert depth.dtype == np.float32
    np.testing.assert_allclose(depth, expected, rtol=2e-6)


def test_where_nothing_is_depth_is_infinite_and_all_else_zero() -> None:
    layers = layers_of(
        [(quad(0.5), Material(), np.eye(4))], square_camera(), *AOVS
    )
    empty = layers["object-id"] == 0
    assert 0 < empty.mean() < 1
    assert np.isinf(layers["depth"][empty]).all()
    assert np.isfinite(layers["depth"][~empty]).all()
    for name, values in layers.items():
        assert values.dtype == AOVS[name].dtype
        if name != "depth":
            assert not values[empty].any(), name


def test_values_are_the_material_s_and_the_surface_s() -> None:
    material = Material(
        base_colour_factor=(0.25, 0.5, 0.75, 1.0),
        roughness_factor=0.375,
        metallic_factor=0.625,
        emissive_factor=(0.5, 2.0, 0.125),
    )
    layers = layers_of(
        [(quad(100.0), material, turned(-40))], square_camera(), *AOVS
    )
    middle = {name: values[8, 12] for name, values in layers.items()}
    np.testing.assert_array_equal(middle["albedo"], [0.25, 0.5, 0.75])
    assert middle["roughness"] == 0.375
    assert middle["metallic"] == 0.625
    np.testing.assert_array_equal(middle["emission"], [0.5, 2.0, 0.125])
    assert middle["occlusion"] == 1.0
    np.testing.assert_allclose(middle["normal"], turned(-40)[:3, 2], atol=2e-7)
    assert middle["object-id"] == 1


def test_ids_are_nodes_counted_from_one() -> None:
    items = [
        (quad(0.5), Material(), placed_at(-0.5)),
        (quad(0.5), Material(), placed_at(0.5)),
    ]
    ids = layers_of(items, square_camera(), "object-id")["object-id"]
    assert set(np.unique(ids)) == {0, 1, 2}
    assert ids[8, 8] == 1
    assert ids[8, 15] == 2


def test_ids_are_the_numbers_of_the_file_in_whatever_order(
    tmp_path: Path,
) -> None:
    """Also where the file has a child in front of its parent."""
    import pygltflib

    path = tmp_path / "quads.gltf"
    save_model(model_of([(quad(0.5), Material(), placed_at(-0.5))]), path)
    document = pygltflib.GLTF2().load(path)
    mesh = document.nodes[-1].mesh
    document.nodes = [
        pygltflib.Node(mesh=mesh, translation=[0.5, 0, 0]),
        pygltflib.Node(children=[0, 2]),
        pygltflib.Node(mesh=mesh, translation=[-0.5, 0, 0]),
    ]
    document.scenes[0].nodes = [1]
    document.save(path)
    image = moka.render(
        path,
        environment="none",
        size=SIZE,
        camera=square_camera(),
        aov="object-id",
    )
    ids = image.layers["object-id"]
    assert ids[8, 15] == 1
    assert ids[8, 8] == 3


@pytest.mark.parametrize(("alpha", "hit"), [(0.4, 1), (0.6, 2)])
@pytest.mark.parametrize("mode", [AlphaMode.MASK, AlphaMode.BLEND])
def test_what_covers_less_than_half_is_looked_through(
    mode: AlphaMode, alpha: float, hit: int
) -> None:
    glass = Material(base_colour_factor=(1, 1, 1, alpha), alpha_mode=mode)
    items = [
        (quad(2.0), Material(), placed_at(z=-1)),
        (quad(2.0), glass, placed_at(z=1)),
    ]
    ids = layers_of(items, square_camera(), "object-id")["object-id"]
    assert ids[8, 12] == hit


def test_the_picture_is_the_same_with_and_without() -> None:
    plain = moka.render(size=(48, 32), camera="orbit:30,20")
    more = moka.render(size=(48, 32), camera="orbit:30,20", aov="depth")
    assert np.array_equal(plain.pixels, more.pixels)
    assert not plain.layers


def test_reference_lighting_has_them_at_pixel_centres_too() -> None:
    def depth(**options: Any) -> NDArray[np.float32]:
        image = moka.render(size=(16, 16), aov=["depth"], **options)
        found: NDArray[np.float32] = image.layers["depth"]
        return found

    np.testing.assert_array_equal(
        depth(ibl="reference", reference_samples=16), depth()
    )


def test_the_command_writes_layers_and_loads_nothing_without_them(
    tmp_path: Path,
) -> None:
    model = tmp_path / "quad.glb"
    save_model(model_of([(quad(1.0), Material(), np.eye(4))]), model)
    picture = tmp_path / "picture.exr"
    run = (
        "import sys; from moka.cli import main; code = main(sys.argv[1:]); "
        "print('moka.renderer.surface_values' in sys.modules); sys.exit(code)"
    )

    def render(*options: str) -> str:
        done = subprocess.run(
            [
                *(sys.executable, "-c", run, "render", str(model)),
                *("--size", "16x16", "--environment", "none"),
                *("-o", str(picture), *options),
            ],
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.strip()

    assert render() == "False"
    assert read_exr(picture)[1] == {}
    assert render("--aov", "depth,normal,object-id") == "True"
    _, layers = read_exr(picture)
    assert layers.keys() == {"depth", "normal.XYZ", "object-id"}
    assert layers["object-id"].dtype == np.uint32


def test_a_png_has_no_place_for_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from moka.cli import main

    output = tmp_path / "picture.png"
    assert main(["render", "--aov", "depth", "-o", str(output)]) == 2
    assert "--aov: needs an output that ends in .exr" in capsys.readouterr().err
    assert not output.exists()
