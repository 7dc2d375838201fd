"""Skins and morph targets as the GPU places them, against the oracle.

Each vertex is a point of one pixel, known by its colour. Seen in parallel
along the three axes, depth tells each coordinate of its position.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.graphics.device import GraphicsDevice
from moka.model import load_model
from moka.model.cameras import Orthographic
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.renderer.surface_values import unpack_values
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.characters import Character

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
