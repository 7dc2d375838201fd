"""Skins and morph targets as the GPU places them, against the oracle.

Each vertex is a point of one pixel, known by its colour. Seen in parallel
along the three axes, depth tells each coordinate of its position.
"""

import base64
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.core.encoded_image import EncodedImage
from moka.core.png import encode_png
from moka.graphics.device import GraphicsDevice
from moka.material.description import describe_material
from moka.material.material import Material, Texture
from moka.model import cube, load_model, quad
from moka.model.cameras import Orthographic
from moka.model.mesh import ATTRIBUTES, INFLUENCES
from moka.model.morphs import MORPHED
from moka.renderer.permutation import LightingDescription, Permutation
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.renderer.surface_values import unpack_values
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.characters import Character
from tests.support.gltf_file import GltfFile
from tests.support.plain_device import open_plain_device

pytestmark = pytest.mark.gpu

NAMES = ("depth", "normal", "albedo")
SIZE = 256
# Cameras that look along -X, -Y and -Z, as rotations from their space.
VIEWS = [
    np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0)], float),
    np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0)], float),
    np.eye(3),
]


class Stage:
    """A scene, its renderer, and what points of it are."""

    def __init__(self, device: GraphicsDevice) -> None:
        self.device = device
        self.scene = Scene()
        self.renderer = Renderer(device, (SIZE, SIZE), RenderSettings())

    def values(self, camera: Camera) -> dict[str, NDArray[Any]]:
        commands = CommandList()
        read = self.renderer.read_values(self.scene, camera, NAMES, commands)
        self.device.submit(commands).wait()
        return unpack_values(NAMES, read)


@pytest.fixture
def stage(egl_device: GraphicsDevice) -> Iterator[Stage]:
    stage = Stage(egl_device)
    yield stage
    stage.renderer.close()


def look_along(axis: int, centre: NDArray[Any], reach: float) -> Camera:
    camera = Camera(Orthographic(reach, reach, 0.1, 4 * reach))
    matrix = np.eye(4)
    matrix[:3, :3] = VIEWS[axis]
    matrix[:3, 3] = centre + 2 * reach * VIEWS[axis][:, 2]
    camera.transform.local_matrix = matrix
    return camera


def check(stage: Stage, character: Character, rounding: float = 2e-6) -> None:
    """Compare all points that can be seen; nearly all can, in each view.

    ``rounding`` is of positions, relative to the reach of the vertices.
    """
    wanted = character.expected()
    points = wanted["POSITION"]
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    reach = 1.1 * float(np.abs(points - centre).max())
    for axis, turn in enumerate(VIEWS):
        camera = look_along(axis, centre, reach)
        layers = stage.values(camera)
        albedo = layers["albedo"]
        rows, columns = np.nonzero(np.isfinite(layers["depth"]))
        number = np.floor(albedo[rows, columns, 0] * character.count)
        vertex = number.astype(int)
        assert len(set(vertex.tolist())) > 0.9 * character.count
        seen = (points[vertex] - centre) @ turn
        depth = layers["depth"][rows, columns]
        np.testing.assert_allclose(
            depth, 2 * reach - seen[:, 2], rtol=0, atol=rounding * reach
        )
        # The pixel's middle is at most half a pixel away, and rounding.
        step = 2 * reach / SIZE
        across = (columns + 0.5) * step - reach
        upward = reach - (rows + 0.5) * step
        assert np.abs(seen[:, 0] - across).max() < 0.51 * step
        assert np.abs(seen[:, 1] - upward).max() < 0.51 * step
        np.testing.assert_allclose(
            layers["normal"][rows, columns],
            wanted["NORMAL"][vertex],
            rtol=0,
            atol=2e-5,
        )
        np.testing.assert_allclose(
            albedo[rows, columns],
            wanted["COLOR_0"][vertex, :3],
            rtol=0,
            atol=1e-6,
        )


@pytest.mark.parametrize(
    "kind",
    [
        {"joints": 2},
        {"joints": 12, "sets": 2},
        {"joints": 30, "sets": 3},
        {"joints": 200, "sets": 1},
        {"scales": (0.5, 2.0)},
        {"scales": (0.7, 1.5), "mirrored": True},
        {"has_inverse_bind": False},
        {"joints": 0, "targets": 1},
        {"joints": 0, "targets": 5, "morphs_colour": True},
        {"joints": 0, "targets": 300, "active": 4, "vertices": 60},
        {"joints": 5, "targets": 4, "scales": (0.8, 1.3)},
        {"joints": 5, "targets": 3, "active": 0},
    ],
    ids=lambda kind: ",".join(f"{k}={v}" for k, v in kind.items()),
)
def test_vertices_are_where_the_oracle_puts_them(
    stage: Stage, kind: dict[str, Any]
) -> None:
    character = Character(**kind)
    stage.scene.add(load_model(character.glb()))
    check(stage, character)


def test_a_million_metres_away_detail_stays(stage: Stage) -> None:
    """The joints' own translations are float64 in the scene."""
    character = Character(joints=8, far=2.0**20, seed=4)
    stage.scene.add(load_model(character.glb()))
    check(stage, character, rounding=4e-6)


def test_meshes_share_buffers_textures_and_a_skeleton(stage: Stage) -> None:
    """Lists of targets and vertices of the second begin somewhere else."""
    file = GltfFile()
    characters = [
        Character(joints=5, targets=4, vertices=90, seed=seed)
        for seed in (1, 2)
    ]
    for character in characters:
        character.add_to(file)
    # Both follow the joints of the first, each with matrices of its own.
    skins = file.document["skins"]
    skins[1]["joints"] = skins[0]["joints"]
    characters[1].local = characters[0].local
    characters[1].parents = characters[0].parents
    model = load_model(file.glb())
    for shown in (0, 1):
        placed = stage.scene.add(model)
        other = np.flatnonzero(model.nodes.mesh >= 0)[1 - shown]
        placed.node(int(other)).visible = False
        check(stage, characters[shown])
        placed.remove()


def test_joints_without_a_skin_leave_a_mesh_rigid(stage: Stage) -> None:
    character = Character(joints=3, targets=3, vertices=80, seed=3)
    file = GltfFile()
    character.add_to(file)
    del file.document["nodes"][-1]["skin"]
    del file.document["nodes"][-1]["translation"]
    stage.scene.add(load_model(file.glb()))
    character.sets = 0
    check(stage, character)
    assert len(stage.scene.drawables.primitives) == 1


def test_copies_have_poses_of_their_own(stage: Stage) -> None:
    character = Character(joints=4, targets=3, seed=7)
    model = load_model(character.glb())
    copies = [stage.scene.add(model) for _ in range(3)]
    mesh = int(np.flatnonzero(model.nodes.mesh >= 0)[0])
    character.weights = np.array([0.25, -0.5, 1.0])
    for number, copy in enumerate(copies):
        copy.visible = number == 1
        assert copy.morph_weights is not None
        copy.morph_weights.set(mesh, character.weights * (number == 1))
    root = model.nodes.names.index("joint 0")
    character.local[0, :3, 3] += (0.5, 0, 0)
    copies[1].node(root).local_matrix = character.local[0]
    check(stage, character)


def test_without_newer_features_of_opengl() -> None:
    with open_plain_device() as device:
        stage = Stage(device)
        for seed in (8, 9):
            character = Character(joints=3, targets=3, vertices=60, seed=seed)
            placed = stage.scene.add(load_model(character.glb()))
            check(stage, character, rounding=4e-6)
            placed.visible = False
        stage.renderer.close()


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_mirrored_skeleton_shows_its_outside(
    stage: Stage, mirrored: bool
) -> None:
    """A cube of one-sided faces: the near side is seen and faces the eye."""
    file = GltfFile()
    shape = cube(1.0)
    mesh = file.mesh(shape.attributes, shape.indices)
    count = shape.vertex_count
    file.document["meshes"][mesh]["primitives"][0]["attributes"] |= {
        "JOINTS_0": file.accessor(np.zeros((count, 4)), "u1"),
        "WEIGHTS_0": file.accessor(np.tile([1.0, 0, 0, 0], (count, 1))),
    }
    file.document["skins"] = [{"joints": [0]}]
    file.node(scale=[-1 if mirrored else 1, 1, 1])
    file.node(mesh=mesh, skin=0)
    stage.scene.add(load_model(file.glb()))
    for axis, turn in enumerate(VIEWS):
        layers = stage.values(look_along(axis, np.zeros(3), 1.0))
        middle = SIZE // 2
        assert layers["depth"][middle, middle] == pytest.approx(1.5, abs=1e-5)
        np.testing.assert_allclose(
            layers["normal"][middle, middle], turn[:, 2], atol=1e-6
        )


def test_morphed_coordinates_read_another_part_of_a_texture(
    stage: Stage,
) -> None:
    """Left half red, right half green; a target moves u by a half."""
    file = GltfFile()
    shape = quad(2.0)
    texture = np.zeros((8, 8, 3), np.uint8)
    texture[:, :4, 0] = texture[:, 4:, 1] = 255
    coordinates = 0.25 + 0 * shape.attributes["TEXCOORD_0"]
    mesh = file.mesh(
        {**shape.attributes, "TEXCOORD_0": coordinates}, shape.indices
    )
    primitive = file.document["meshes"][mesh]["primitives"][0]
    moved = np.zeros((shape.vertex_count, 2))
    moved[:, 0] = 0.5
    primitive["targets"] = [{"TEXCOORD_0": file.accessor(moved)}]
    primitive["material"] = 0
    image = base64.b64encode(encode_png(texture)).decode()
    file.document["images"] = [{"uri": f"data:image/png;base64,{image}"}]
    file.document["textures"] = [{"source": 0}]
    file.document["materials"] = [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    ]
    file.node(mesh=mesh)
    placed = stage.scene.add(load_model(file.glb()))
    assert placed.morph_weights is not None
    for weight, colour in ((0.0, (1, 0, 0)), (1.0, (0, 1, 0))):
        placed.morph_weights.set(0, [weight])
        layers = stage.values(look_along(2, np.zeros(3), 1.0))
        middle = layers["albedo"][SIZE // 2, SIZE // 2]
        np.testing.assert_allclose(middle, colour, atol=1e-3)


def test_all_inputs_of_a_vertex_fit_at_once(
    egl_device: GraphicsDevice,
) -> None:
    """Sixteen attributes, which is what OpenGL 3.3 promises."""
    image = EncodedImage("grey", data=encode_png(np.zeros((2, 2, 3), "u1")))
    material = Material(
        normal_texture=Texture(image),
        base_colour_texture=Texture(image, uv_set=1),
    )
    description = describe_material(
        material, list(ATTRIBUTES), morphed=[*MORPHED]
    )
    assert description.attributes == (
        *(name for name in ATTRIBUTES if name not in INFLUENCES),
        *(
            f"{kind}_{number}"
            for number in range(3)
            for kind in ("JOINTS", "WEIGHTS")
        ),
    )
    lighting = LightingDescription(False, 2, "gltf", "lambert", True, False)
    egl_device.create_program(
        Permutation(description, lighting).program(), wait=True
    )
