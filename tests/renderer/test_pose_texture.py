"""What a frame uploads for skins and morph targets, and that others pay none.

On the recording backend, so that every command can be looked at.
"""

import re
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.commands import FillTexture
from moka.commands.descriptors import ProgramDescriptor
from moka.graphics.device import GraphicsDevice
from moka.material.description import describe_material
from moka.material.material import Material
from moka.model import cube, load_model
from moka.model.assemble import model_of
from moka.renderer.permutation import LightingDescription, Permutation
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.characters import Character
from tests.support.glsl import preprocessed

WORDS = re.compile(r"\b(joint|skin|morph|pose|target)", re.IGNORECASE)


class Studio:
    """A scene, and what the recording backend was asked in each frame."""

    def __init__(self) -> None:
        self.backend = RecordingBackend()
        self.device = GraphicsDevice(lambda: self.backend)
        self.scene = Scene()
        self.renderer = Renderer(self.device, (64, 64), RenderSettings())
        self.camera = Camera()
        self.camera.transform.translate((0, 0, 30))

    def frame(self) -> list[FillTexture]:
        """Draw; the writes to textures of that frame."""
        commands = CommandList()
        self.renderer.draw(self.scene, self.camera, commands)
        self.device.submit(commands).wait()
        steps = self.backend.frames[-1].steps
        return [step for step in steps if isinstance(step, FillTexture)]


@pytest.fixture
def studio() -> Iterator[Studio]:
    studio = Studio()
    with studio.device:
        yield studio
        studio.renderer.close()


def test_one_upload_for_what_moves_and_none_for_what_is_still(
    studio: Studio,
) -> None:
    model = load_model(Character(joints=20, targets=3).glb())
    placed = [studio.scene.add(model) for _ in range(30)]
    first = studio.frame()
    # All of it at once: 20 joints of 3 texels, and lists of up to 3 targets.
    assert [len(each.data) // 16 for each in first] == [30 * (60 + 4)]
    assert studio.frame() == []
    studio.camera.transform.translate((0.1, 0, 0))
    assert studio.frame() == []
    placed[7].node(3).translate((0, 0.1, 0))
    assert [len(each.data) // 16 for each in studio.frame()] == [60]
    mesh = int(np.flatnonzero(model.nodes.mesh >= 0)[0])
    weights = placed[20].morph_weights
    assert weights is not None
    weights.set(mesh, (0.5, 0, 0))
    assert [len(each.data) // 16 for each in studio.frame()] == [2]
    weights.set(mesh, (0.5, 0, 0))
    assert studio.frame() == []


def test_what_nobody_sees_is_uploaded_when_it_is_seen(studio: Studio) -> None:
    model = load_model(Character(joints=4).glb())
    placed = studio.scene.add(model)
    studio.scene.add(model_of([(cube(), None, np.eye(4))]))
    studio.frame()
    placed.transform.translate((1000, 0, 0))
    assert studio.frame() == []
    placed.node(1).translate((0, 0.1, 0))
    assert studio.frame() == []
    placed.transform.translate((-1000, 0, 0))
    assert len(studio.frame()) == 1


def test_characters_of_one_mesh_are_one_draw(studio: Studio) -> None:
    model = load_model(Character(joints=4, targets=2).glb())
    placed = [studio.scene.add(model) for _ in range(25)]
    for number, each in enumerate(placed):
        each.transform.translate((number % 5 - 2, number // 5 - 2, 0))
    studio.frame()
    recording = studio.backend.frames[-1]
    batches = studio.backend.batches[-1]
    surfaces = recording.draws[recording.draws["instance_count"] > 0]
    programs = [
        slot
        for slot, count in zip(
            *np.unique(surfaces["program"], return_counts=True), strict=True
        )
        if count == 25
    ]
    assert len(programs) == 1
    assert list(batches.program).count(programs[0]) == 1
    # Each has a place of its own in the texture.
    rows = np.flatnonzero(recording.draws["program"] == programs[0])
    first = recording.draws["first_instance"][rows]
    places = recording.instances["spare"][first]
    assert len(np.unique(places[:, 0])) == len(np.unique(places[:, 1])) == 25


def test_only_active_targets_are_in_the_list(studio: Studio) -> None:
    character = Character(joints=0, targets=40, active=2, seed=5)
    studio.scene.add(load_model(character.glb()))
    (upload,) = studio.frame()
    texels = np.frombuffer(upload.data, np.float32).reshape(-1, 4)
    assert texels[0, 0] == 2
    np.testing.assert_allclose(
        sorted(texels[1:3, 0]),
        sorted(character.weights[character.weights != 0]),
        rtol=1e-6,
    )
    assert not texels[3:].any()


def sources(**deforms: object) -> ProgramDescriptor:
    """The program of a plain material on a mesh that may deform."""
    attributes = ["POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"]
    attributes += deforms.get("follows", [])
    return Permutation(
        describe_material(
            Material(), attributes, morphed=deforms.get("morphed", ())
        ),
        LightingDescription(True, 2, "gltf", "lambert", True, False),
    ).program()


def test_a_plain_shader_has_no_word_of_poses() -> None:
    plain = sources()
    for stage in (plain.vertex, plain.fragment):
        text = preprocessed(stage.source)
        assert "void main" in text
        assert not WORDS.search(text)
    # The test would see them.
    deformed = sources(follows=["JOINTS_0", "WEIGHTS_0"], morphed=["POSITION"])
    assert "samplerBuffer poses" in preprocessed(deformed.vertex.source)
    assert preprocessed(deformed.fragment.source) == preprocessed(
        plain.fragment.source
    )


def test_a_plain_picture_imports_nothing_of_poses(tmp_path: object) -> None:
    code = (
        "import sys, numpy as np\n"
        "from moka.graphics.device import GraphicsDevice\n"
        "from moka.backend.recording_backend import RecordingBackend\n"
        "from moka.commands.command_list import CommandList\n"
        "from moka.renderer.renderer import Renderer\n"
        "from moka.scene.camera import Camera\n"
        "from moka.scene.scene import Scene\n"
        "from moka.model import cube, load_model, model_of, save_model\n"
        f"path = {str(tmp_path)!r} + '/cube.glb'\n"
        "save_model(model_of([(cube(), None, np.eye(4))]), path)\n"
        "scene = Scene()\n"
        "scene.add(load_model(path))\n"
        "with GraphicsDevice(RecordingBackend) as device:\n"
        "    renderer = Renderer(device, (8, 8))\n"
        "    commands = CommandList()\n"
        "    renderer.draw(scene, Camera(), commands)\n"
        "    device.submit(commands).wait()\n"
        "    renderer.close()\n"
        "print(*sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = set(done.stdout.split())
    assert "moka.renderer.renderer" in loaded
    assert not loaded & {
        "moka.model.morphs",
        "moka.model.posed_bounds",
        "moka.model.skins",
        "moka.renderer.morph_deltas",
        "moka.renderer.pose_texture",
        "moka.scene.morph_poses",
        "moka.scene.morph_weights",
        "moka.scene.poses",
        "moka.scene.skin_poses",
    }


def test_a_plain_scene_uploads_no_poses(studio: Studio) -> None:
    studio.scene.add(model_of([(cube(), None, np.eye(4))]))
    assert studio.frame() == []
    textures = {
        descriptor.label
        for descriptor in studio.backend.resources.values()
        if hasattr(descriptor, "label")
    }
    assert not textures & {"poses", "morph deltas"}
    assert not studio.backend.frames[-1].instances["spare"].any()
