"""Real characters in their poses: upright, whole, and inside their boxes."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.core.maths import invert_affine
from moka.graphics.device import GraphicsDevice
from moka.model import load_model
from moka.model.cameras import Orthographic
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.renderer.surface_values import unpack_values
from moka.scene.camera import Camera
from moka.scene.scene import Scene

pytestmark = [pytest.mark.gpu, pytest.mark.assets]

SIZE = 192


def visible_points(
    device: GraphicsDevice, scene: Scene, reach: float
) -> NDArray[np.float64]:
    """Where the surfaces are that are seen from +Z, (P, 3) in metres."""
    camera = Camera(Orthographic(reach, reach, 0.1, 10 * reach))
    camera.transform.translate((0, 0.5 * reach, 3 * reach))
    renderer = Renderer(device, (SIZE, SIZE), RenderSettings())
    commands = CommandList()
    read = renderer.read_values(scene, camera, ["depth"], commands)
    device.submit(commands).wait()
    renderer.close()
    depth = unpack_values(["depth"], read)["depth"]
    rows, columns = np.nonzero(np.isfinite(depth))
    step = 2 * reach / SIZE
    seen = np.stack(
        [
            (columns + 0.5) * step - reach,
            reach - (rows + 0.5) * step,
            -depth[rows, columns].astype(float),
            np.ones(len(rows)),
        ]
    )
    return (invert_affine(camera.view_matrix) @ seen)[:3].T


@pytest.mark.parametrize(
    ("name", "height"), [("Soldier.glb", 1.8), ("Michelle.glb", 1.65)]
)
@pytest.mark.parametrize("time", [None, 0.0, 0.4, 0.9])
def test_a_character_stands_in_its_box(
    egl_device: GraphicsDevice,
    assets: Path,
    name: str,
    height: float,
    time: float | None,
) -> None:
    scene = Scene()
    placed = scene.add(load_model(assets / "models" / name))
    if time is not None:
        placed.animations.pose(len(placed.model.animations) - 1, time)
    scene.update()
    box = scene.bounds()
    assert box is not None
    points = visible_points(egl_device, scene, 2.0)
    found = np.stack([points.min(axis=0), points.max(axis=0)])
    pixel = 4.0 / SIZE
    assert (found[0] > box[0] - pixel).all()
    assert (found[1] < box[1] + pixel).all()
    # As tall as a person who stands, its feet near the ground, and one body
    # without holes: its widest row is not wider than arms reach.
    size = found[1] - found[0]
    assert size[1] == pytest.approx(height, rel=0.15)
    assert abs(found[0, 1]) < 0.2
    assert size[0] < 1.2 * height
    # The box is not absurdly larger than what is in it.
    assert (box[1] - box[0])[1] < 1.25 * size[1]


def test_morph_targets_stretch_their_boxes(
    egl_device: GraphicsDevice, assets: Path
) -> None:
    scene = Scene()
    placed = scene.add(load_model(assets / "models" / "MorphStressTest.gltf"))
    weights = placed.morph_weights
    assert weights is not None
    tops = []
    for active in (0.0, 1.0):
        weights.set(0, [active, 0, 0, 0, 0, 0, 0, 0])
        scene.update()
        box = scene.bounds()
        assert box is not None
        points = visible_points(egl_device, scene, 3.0)
        assert points[:, 1].max() == pytest.approx(box[1, 1], abs=0.05)
        tops.append(points[:, 1].max())
    assert tops[1] > 1.5 * tops[0]
