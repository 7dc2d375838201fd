"""Which scenes are drawn through a visibility buffer, and what they upload.

On the recording backend, so that every command can be looked at.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from msgspec.structs import replace

from moka.backend.protocol import BackendInfo
from moka.backend.recording_backend import RecordingBackend
from moka.commands.command_list import CommandList
from moka.commands.commands import FillTexture
from moka.commands.draws import INSTANCE
from moka.commands.recording import Recording
from moka.graphics.device import GraphicsDevice
from moka.material.material import Material
from moka.model import cube, load_model, quad, sphere
from moka.model.assemble import model_of
from moka.model.model import Model
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from tests.support.characters import Character

SOFTWARE = BackendInfo(
    kind="recording",
    renderer="llvmpipe (LLVM 15.0)",
    max_samples=4,
    max_integer_samples=4,
    clip_control=True,
    max_buffer_texels=1 << 20,
)
GPU = replace(SOFTWARE, renderer="GeForce")


@contextmanager
def drawn(
    *models: Model,
    info: BackendInfo = SOFTWARE,
    matrices: tuple[np.ndarray, ...] = (),
    **settings: object,
) -> Iterator[tuple[Recording, Renderer]]:
    """The recording of a frame that shows the models side by side."""
    backend = RecordingBackend(info)
    scene = Scene()
    for number, model in enumerate(models):
        scene.add(model, matrices[number] if matrices else None)
    camera = Camera()
    camera.transform.translate((0, 0, 30))
    with GraphicsDevice(lambda: backend) as device:
        renderer = Renderer(device, (64, 64), RenderSettings(**settings))
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        device.submit(commands).wait()
        yield backend.frames[-1], renderer
        renderer.close()


def is_used(*models: Model, **options: object) -> bool:
    with drawn(*models, **options) as (recording, _):
        return any(isinstance(step, FillTexture) for step in recording.steps)


def ball(**material: object) -> Model:
    """2208 triangles."""
    return model_of([(sphere(), Material(**material), np.eye(4))])


def test_auto_takes_it_on_software_for_many_triangles() -> None:
    assert is_used(ball())
    assert not is_used(ball(), info=GPU)
    assert not is_used(model_of([(cube(), None, np.eye(4))]))
    # 200 cubes are 2400 triangles.
    many = [(cube(), None, np.eye(4))] * 200
    assert is_used(model_of(many))
    # One sample of what is cheap to shade.
    assert not is_used(ball(), samples=1)


def test_both_can_be_asked_for() -> None:
    small = model_of([(cube(), None, np.eye(4))])
    assert is_used(small, info=GPU, shading="visibility")
    assert is_used(small, shading="visibility", samples=1)
    assert not is_used(ball(), shading="forward")


UNSUITED: dict[str, Callable[[], Model]] = {
    "two programs": lambda: model_of(
        [
            (sphere(), Material(), np.eye(4)),
            (sphere(), Material(unlit=True), np.eye(4)),
        ]
    ),
    "a skin": lambda: load_model(Character(joints=3).glb()),
    "morph targets": lambda: load_model(Character(targets=2).glb()),
}


@pytest.mark.parametrize("name", UNSUITED)
def test_it_is_for_rigid_triangles_of_one_program(name: str) -> None:
    with drawn(UNSUITED[name](), shading="visibility") as (_, renderer):
        assert renderer.has_drawn
        # Samples are where they were.
        assert renderer._targets.current.samples == 4


def test_materials_have_to_fit_one_page() -> None:
    """A page of 16 KiB holds 341 rows of 48 bytes."""

    def squares(count: int) -> Model:
        square = quad()
        return model_of(
            [
                (square, Material(roughness_factor=i / 400), np.eye(4))
                for i in range(count)
            ]
        )

    assert is_used(squares(341), shading="visibility")
    assert not is_used(squares(342), shading="visibility")


@pytest.mark.parametrize(
    ("texels", "used"),
    [
        # 4 vertices of 3 texels, 6 indices, 50 rows of 4 texels.
        (199, False),
        (200, True),
    ],
)
def test_a_driver_has_to_read_all_rows(texels: int, used: bool) -> None:
    info = replace(SOFTWARE, max_buffer_texels=texels)
    square = quad()
    many = model_of([(square, None, np.eye(4))] * 50)
    assert is_used(many, info=info, shading="visibility") == used


@pytest.mark.parametrize("uploaded", [False, True])
def test_a_driver_has_to_read_all_vertices(uploaded: bool) -> None:
    # 2208 triangles have 6624 indices.
    info = replace(SOFTWARE, max_buffer_texels=6623)
    backend = RecordingBackend(info)
    scene = Scene()
    scene.add(ball())
    with GraphicsDevice(lambda: backend) as device:
        settings = RenderSettings(shading="visibility")
        renderer = Renderer(device, (64, 64), settings)
        if uploaded:
            renderer.settings = replace(settings, shading="forward")
            renderer.draw(scene, Camera(), CommandList())
            renderer.settings = settings
        commands = CommandList()
        renderer.draw(scene, Camera(), commands)
        device.submit(commands).wait()
        renderer.close()
    steps = backend.frames[-1].steps
    assert not any(isinstance(each, FillTexture) for each in steps)


def test_it_needs_depth_that_is_reversed_and_one_frame() -> None:
    plain = replace(SOFTWARE, clip_control=False)
    assert not is_used(ball(), info=plain, shading="visibility")
    assert not is_used(ball(), ibl="reference", shading="visibility")


def test_numbers_of_triangles_need_as_many_samples_as_radiance() -> None:
    """OpenGL 3.3 asks for one sample of whole numbers."""
    info = replace(SOFTWARE, max_integer_samples=1)
    assert not is_used(ball(), info=info, shading="visibility")
    assert is_used(ball(), info=info, shading="visibility", samples=1)


def test_what_comes_later_has_buffers_of_its_own() -> None:
    backend = RecordingBackend(SOFTWARE)
    scene = Scene()
    scene.add(ball())
    with GraphicsDevice(lambda: backend) as device:
        renderer = Renderer(device, (64, 64), RenderSettings())
        used = []
        for _ in range(2):
            commands = CommandList()
            renderer.draw(scene, Camera(), commands)
            device.submit(commands).wait()
            steps = backend.frames[-1].steps
            used.append(any(isinstance(each, FillTexture) for each in steps))
            scene.add(ball())
        renderer.close()
    assert used == [True, False]


def test_instances_tell_where_their_triangles_are() -> None:
    flipped = np.diag((-1.0, 1.0, 1.0, 1.0))
    box = cube()
    model = model_of(
        [
            (quad(), None, np.eye(4)),
            (box, None, flipped),
            (box, None, np.eye(4)),
        ]
    )
    with drawn(model, shading="visibility") as (recording, _):
        (filled,) = (
            step for step in recording.steps if isinstance(step, FillTexture)
        )
    rows = np.frombuffer(filled.data, INSTANCE)
    np.testing.assert_array_equal(rows, recording.instances[: len(rows)])
    assert len(rows) == 3
    # 12 triangles, counted from 1, are 4 bits.
    np.testing.assert_array_equal(
        rows["spare"][:, 0], np.arange(3, dtype=np.uint32) << 4
    )
    first, mirrored = (
        rows["spare"][:, 1] & 0x7FFFFFFF,
        rows["spare"][:, 1] >> 31,
    )
    # The quad's 6 indices and 4 vertices come before the cubes'.
    is_cube = first > 0
    assert sorted(first.tolist()) == [0, 6, 6]
    np.testing.assert_array_equal(rows["object"], np.where(is_cube, 4, 0))
    expected = rows["transform"][:, 0, 0] < 0
    np.testing.assert_array_equal(mirrored, expected)
    assert expected.sum() == 1
