"""Materials with other numbers: the picture of the model that has them."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.handles import ResourceKind
from moka.core.errors import OptionError
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import load_environment
from moka.material.material import Material
from moka.model import quad
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.scene import Scene
from tests.support.pictures import scene_of, square_camera

pytestmark = pytest.mark.gpu

BEFORE = Material(
    base_colour_factor=(0.8, 0.2, 0.1, 1.0),
    roughness_factor=0.3,
    metallic_factor=0.25,
    emissive_factor=(0.1, 0.0, 0.0),
)
NUMBERS = {
    "base_colour_factor": (0.1, 0.7, 0.3, 1.0),
    "roughness_factor": 0.7,
    "metallic_factor": 0.5,
    "emissive_factor": (0.0, 0.0, 0.4),
}


def draw(renderer: Renderer, scene: Scene) -> NDArray[np.float32]:
    commands = CommandList()
    renderer.draw(scene, square_camera(), commands)
    read = renderer.read_radiance(commands)
    renderer.device.submit(commands).wait()
    assert read.data is not None
    pixels: NDArray[np.float32] = read.data
    return pixels


def test_edits_draw_what_the_numbers_say_with_the_same_programs(
    device: GraphicsDevice,
) -> None:
    environment = load_environment("studio")
    renderer = Renderer(device, (8, 8), RenderSettings(float_output=True))
    scene = scene_of([(quad(2.0), BEFORE, np.eye(4))], environment)
    first = draw(renderer, scene)
    programs = renderer.statistics.counts["programs"]
    scene.edit_material(BEFORE, **NUMBERS)
    edited = draw(renderer, scene)
    assert renderer.statistics.counts["programs"] == programs
    assert scene.material_now(BEFORE).roughness_factor == 0.7

    wanted = scene_of(
        [(quad(2.0), replace(BEFORE, **NUMBERS), np.eye(4))], environment
    )
    expected = draw(renderer, wanted)
    np.testing.assert_array_equal(edited, expected)
    assert np.abs(edited - first).max() > 0.1
    # One after the other adds up.
    scene.edit_material(BEFORE, roughness_factor=BEFORE.roughness_factor)
    assert scene.material_now(BEFORE).metallic_factor == 0.5
    renderer.close()


@pytest.mark.parametrize(
    "numbers",
    [
        {"ior": 2.0},
        {"ior": 1.5, "specular_factor": 1.0},
        {"specular_factor": 0.0},
        {"specular_colour_factor": (0.2, 3.0, 1.0)},
        {"metallic_factor": 0.0, "emissive_factor": (0.0, 0.0, 0.0)},
        {"metallic_factor": 1.0},
    ],
)
def test_numbers_of_extensions_and_special_ones_need_no_other_program(
    egl_device: GraphicsDevice, numbers: dict[str, Any]
) -> None:
    environment = load_environment("studio")
    renderer = Renderer(egl_device, (8, 8), RenderSettings(float_output=True))
    lacquer = replace(BEFORE, ior=1.3, specular_factor=0.9)
    scene = scene_of([(quad(2.0), lacquer, np.eye(4))], environment)
    first = draw(renderer, scene)
    counts = dict(renderer.statistics.counts)
    handles = [egl_device.count(kind) for kind in ResourceKind]
    scene.edit_material(lacquer, **numbers)
    edited = draw(renderer, scene)
    assert renderer.statistics.counts == counts
    assert [egl_device.count(kind) for kind in ResourceKind] == handles
    assert np.abs(edited - first).max() > 0.001

    wanted = scene_of(
        [(quad(2.0), replace(lacquer, **numbers), np.eye(4))], environment
    )
    # Which may be drawn by a simpler program.
    np.testing.assert_allclose(
        edited, draw(renderer, wanted), rtol=1e-5, atol=1e-6
    )
    renderer.close()


def test_what_needs_another_program_is_refused() -> None:
    scene = scene_of([(quad(2.0), BEFORE, np.eye(4))])
    dark = Material()
    for material, numbers, text in (
        (dark, {"emissive_factor": (1, 0, 0)}, "another program"),
        (dark, {"metallic_factor": 0.5}, "another program"),
        (BEFORE, {"ior": 1.4}, "another program"),
        (BEFORE, {"roughness_factor": 1.5}, "from 0 to 1"),
        (BEFORE, {"roughness_factor": np.nan}, "from 0 to 1"),
        (BEFORE, {"base_colour_factor": (1, 1, 1)}, "takes 4"),
        (BEFORE, {"unlit": True}, "no number"),
    ):
        with pytest.raises(OptionError, match=text):
            scene.edit_material(material, **numbers)
    assert scene.live_materials is None
