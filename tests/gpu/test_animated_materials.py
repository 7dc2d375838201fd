"""Materials, visibility and lights that pointers move, in pictures."""

from typing import Any

import numpy as np
import pytest

import moka
from moka.material.description import Feature, describe_material
from moka.material.material import Material
from moka.scene.scene import Scene
from tests.support.animated import AnimatedFile

pytestmark = pytest.mark.gpu

SIZE = (24, 16)
UNLIT = {"extensions": {"KHR_materials_unlit": {}}}
COLOUR = "/materials/0/pbrMetallicRoughness/baseColorFactor"


def glowing() -> AnimatedFile:
    """A triangle whose unlit colour goes from red to green in a second."""
    file = AnimatedFile(materials=[UNLIT])
    ends = [(1.0, 0, 0, 1), (0, 1.0, 0, 1)]
    file.channel(COLOUR, [0, 1], ends)
    return file


def middle(image: moka.Image) -> Any:
    """The colour of the triangle, as its inner pixels have it."""
    covered = image.pixels[image.pixels[:, :, 3] == 1]
    return np.median(covered[:, :3], axis=0)


def shot(file: AnimatedFile, time: float, **options: Any) -> moka.Image:
    return moka.render(
        file.glb(),
        time=time,
        size=SIZE,
        samples=1,
        **{
            "environment": "none",
            "background": "transparent",
            **options,
        },
    )


@pytest.mark.parametrize("time", [0.0, 0.25, 1.0])
def test_a_factor_has_the_value_of_its_time(time: float) -> None:
    image = shot(glowing(), time, aov="albedo")
    np.testing.assert_allclose(middle(image), (1 - time, time, 0), atol=1e-3)
    albedo = image.layers["albedo"]
    np.testing.assert_allclose(
        albedo[albedo.any(axis=-1)].max(axis=0)[:3],
        (1 - time, time, 0),
        atol=1e-3,
    )


class Changing(moka.App):
    """Plays what it is given; prepares its scene how often?"""

    file: AnimatedFile

    def load(self) -> None:
        model = moka.load_model(self.file.glb())
        self.models = [
            self.scene.add(model, np.diag([1, 1, 1, 1.0])),
            self.scene.add(model, moka.Transform((2, 0, 0))),
        ]
        self.scene.background = "transparent"
        self.models[0].animations.play()
        self.camera.frame([(0, 0, 0), (3, 2, 0)], SIZE[0] / SIZE[1])
        self.prepared: list[Any] = []

    def draw(self, time: moka.GameTime, commands: moka.CommandList) -> None:
        super().draw(time, commands)
        self.prepared.append(self.renderer._scene.prepared)


def test_a_frame_changes_rows_and_prepares_nothing_anew() -> None:
    app = Changing()
    app.file = glowing()
    moka.run(app, headless=True, frames=31, size=SIZE)
    assert len({id(each) for each in app.prepared}) == 1
    assert app.image is not None
    pixels = app.image.pixels
    solid = pixels[:, :, 3] == 1
    left, right = np.split(pixels, 2, axis=1)
    # The copy that does not play keeps the colour of the file: white.
    moving = left[np.split(solid, 2, axis=1)[0]]
    still = right[np.split(solid, 2, axis=1)[1]]
    np.testing.assert_allclose(
        np.median(moving[:, :3], axis=0), (0.5, 0.5, 0), atol=1e-3
    )
    np.testing.assert_allclose(np.median(still[:, :3], axis=0), 1, atol=1e-3)


def test_emission_may_grow_from_nothing() -> None:
    file = AnimatedFile(
        materials=[
            {
                "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
                "extensions": {
                    "KHR_materials_emissive_strength": {"emissiveStrength": 4}
                },
            }
        ]
    )
    file.channel(
        "/materials/0/emissiveFactor", [0, 1], [(0.0, 0, 0), (1.0, 0.5, 0)]
    )
    np.testing.assert_allclose(middle(shot(file, 0.0)), 0, atol=1e-3)
    np.testing.assert_allclose(middle(shot(file, 0.5)), (2, 1, 0), atol=2e-3)


def test_factor_and_strength_multiply_at_each_time() -> None:
    file = AnimatedFile(
        materials=[
            {
                "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
                "extensions": {
                    "KHR_materials_emissive_strength": {"emissiveStrength": 9}
                },
            }
        ]
    )
    file.channel(
        "/materials/0/emissiveFactor", [0, 1], [(0.0, 0, 0), (1.0, 0.5, 0)]
    )
    file.channel(
        "/materials/0/extensions/KHR_materials_emissive_strength/"
        "emissiveStrength",
        [0, 1],
        [2.0, 6.0],
    )
    np.testing.assert_allclose(
        middle(shot(file, 0.5)), (0.5 * 4, 0.25 * 4, 0), atol=2e-3
    )


def test_a_hidden_node_appears_at_its_time() -> None:
    file = AnimatedFile(materials=[UNLIT])
    file.document["nodes"][0]["extensions"] = {
        "KHR_node_visibility": {"visible": False}
    }
    steps = file.accessor(np.array([0, 1, 0], "u1"))
    file.channel(
        "/nodes/0/extensions/KHR_node_visibility/visible",
        [0, 1, 2],
        steps,
        "STEP",
    )
    camera = moka.Camera()
    camera.transform.position = (0.5, 1, 4)
    seen = [
        bool(shot(file, time, camera=camera).pixels.any())
        for time in (0.0, 0.9, 1.0, 1.9, 2.0)
    ]
    assert seen == [False, False, True, True, False]


def test_a_light_grows_brighter() -> None:
    file = AnimatedFile(
        2,
        extensions={
            "KHR_lights_punctual": {
                "lights": [{"type": "directional", "intensity": 1}]
            }
        },
    )
    file.document["nodes"][1] = {
        "extensions": {"KHR_lights_punctual": {"light": 0}}
    }
    file.channel(
        "/extensions/KHR_lights_punctual/lights/0/intensity",
        [0, 1],
        [1.0, 3.0],
    )
    dim, bright = (middle(shot(file, time)) for time in (0.0, 1.0))
    assert dim.min() > 0
    np.testing.assert_allclose(bright, 3 * dim, rtol=2e-3)


def test_programs_are_made_for_all_values() -> None:
    plain = describe_material(Material(), ("POSITION", "NORMAL"))
    moving = Material(animated=frozenset({"emissive_factor"}))
    assert Feature.EMISSIVE not in plain.features
    described = describe_material(moving, ("POSITION", "NORMAL"))
    assert described.features == plain.features | Feature.EMISSIVE
    # What needs no other program does not get one.
    colours = Material(animated=frozenset({"base_colour_factor"}))
    assert describe_material(colours, ("POSITION", "NORMAL")) == plain


def test_a_still_model_has_no_live_materials() -> None:
    scene = Scene()
    scene.add(moka.load_model(AnimatedFile().glb()))
    assert scene.live_materials is None


def test_a_texture_slides(tmp_path: Any) -> None:
    from PIL import Image

    texels = np.zeros((2, 4, 3), np.uint8)
    texels[:, :2] = 255
    Image.fromarray(texels).save(tmp_path / "halves.png")
    uv = np.full((3, 2), (0.25, 0.5), np.float32)
    file = AnimatedFile(
        materials=[
            {
                **UNLIT,
                "pbrMetallicRoughness": {
                    "baseColorTexture": {
                        "index": 0,
                        "extensions": {"KHR_texture_transform": {}},
                    }
                },
            }
        ],
        textures=[{"source": 0, "sampler": 0}],
        samplers=[{"minFilter": 9728, "magFilter": 9728}],
    )
    view = file.accessor(
        np.frombuffer((tmp_path / "halves.png").read_bytes(), "u1")
    )
    file.document["images"] = [
        {
            "bufferView": file.document["accessors"][view]["bufferView"],
            "mimeType": "image/png",
        }
    ]
    (primitive,) = file.document["meshes"][0]["primitives"]
    primitive["attributes"]["TEXCOORD_0"] = file.accessor(uv)
    file.channel(
        "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/"
        "KHR_texture_transform/offset",
        [0, 1],
        [(0.0, 0.0), (0.5, 0.0)],
    )
    assert middle(shot(file, 0.0)).min() == pytest.approx(1, abs=1e-3)
    assert middle(shot(file, 1.0)).max() == pytest.approx(0, abs=1e-3)
