"""Scenes: what is added, moved, hidden and removed."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from moka.core.errors import ModelError, OptionError
from moka.model.cameras import CameraDescription, Perspective
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Mesh, Primitive
from moka.model.model import Model
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from moka.scene.scene_model import SceneModel
from moka.scene.transform import Transform
from tests.scene.models import make_model

POINT = PunctualLight(LightKind.POINT, intensity=5)


@pytest.fixture
def box() -> Model:
    """One unit cube's corners at a node without a transform."""
    corners = np.array([[-0.5] * 3, [0.5] * 3], np.float32)
    model = make_model([0], [0], [-1])
    model.meshes[0] = Mesh("", [Primitive({"POSITION": corners})])
    model.nodes.local[:] = np.eye(4)
    return model


@pytest.fixture
def scene() -> Scene:
    return Scene()


def test_the_transform_of_a_model_moves_its_nodes(
    scene: Scene, box: Model
) -> None:
    model = scene.add(box)
    model.transform.position = (3, 0, 0)
    model.transform.rotate_around((0, 0, 0), (0, 1, 0), np.pi)
    assert_allclose(
        scene.bounds(), [[-3.5, -0.5, -0.5], [-2.5, 0.5, 0.5]], atol=1e-12
    )


def test_an_empty_scene_has_no_bounds(scene: Scene) -> None:
    assert scene.bounds() is None
    assert scene.visible(Camera(), 1.0).shape == (0,)
    assert scene.light_rows().shape == (0,)


def test_nothing_new_is_no_new_version(scene: Scene, box: Model) -> None:
    scene.add(box)
    scene.update()
    drawables, shown = scene.drawables, scene.shown
    version = scene.transforms.version
    scene.update()
    assert scene.drawables is drawables
    assert scene.shown is shown
    assert scene.transforms.version == version


def test_moving_changes_no_structure(scene: Scene, box: Model) -> None:
    model = scene.add(box)
    scene.update()
    drawables, version = scene.drawables, scene.transforms.version
    model.transform.translate((0, 5, 0))
    scene.update()
    assert scene.drawables is drawables
    assert scene.transforms.version == version + 1
    assert_allclose(drawables.world_bounds[0, :, 1], [4.5, 5.5])


def test_copies_share_primitives(scene: Scene, box: Model) -> None:
    for x in range(5):
        scene.add(box, Transform((x, 0, 0)))
    scene.update()
    assert len(scene.drawables) == 5
    assert len(scene.drawables.primitives) == 1
    assert_allclose(scene.drawables.world_bounds[:, 0, 0], np.arange(5) - 0.5)


def test_a_given_transform_stays_the_handle(scene: Scene, box: Model) -> None:
    transform = Transform((1, 2, 3))
    model = scene.add(box, transform)
    assert model.transform is transform
    transform.position = (4, 5, 6)
    assert_allclose(scene.bounds()[0], [3.5, 4.5, 5.5])


def test_a_matrix_can_be_given(scene: Scene, box: Model) -> None:
    scene.add(box, np.diag([2, 2, -2, 1]))
    assert_allclose(scene.bounds(), [[-1, -1, -1], [1, 1, 1]])
    assert scene.drawables.mirrored.tolist() == [True]


def test_one_transform_moves_one_model(scene: Scene, box: Model) -> None:
    model = scene.add(box)
    for transform in (model.transform, model.node(0)):
        with pytest.raises(OptionError, match="already belongs to a model"):
            scene.add(box, transform)
    other = scene.add(box)
    other.transform.set_parent(model.transform)
    model.transform.position = (7, 0, 0)
    assert_allclose(scene.bounds()[:, 0], [6.5, 7.5])


def test_transforms_of_other_scenes_are_refused(
    scene: Scene, box: Model
) -> None:
    model = Scene().add(box)
    with pytest.raises(OptionError, match="another scene"):
        scene.add(box, model.transform)


def test_hidden_models_are_neither_drawn_nor_shine(scene: Scene) -> None:
    model = scene.add(make_model([1], [0], [-1], lights={0: POINT}))
    scene.add(make_model([1], [0], [-1]))
    scene.update()
    version = scene.visibility_version
    model.visible = False
    scene.update()
    assert scene.visibility_version == version + 1
    assert scene.shown.tolist() == [False, True]
    assert len(scene.light_rows()) == 0
    model.visible = True
    scene.update()
    assert scene.shown.tolist() == [True, True]
    assert len(scene.light_rows()) == 1


def test_removing_a_model_leaves_the_others(scene: Scene, box: Model) -> None:
    first, second = scene.add(box), scene.add(box, Transform((5, 0, 0)))
    scene.update()
    first.remove()
    assert_allclose(scene.bounds()[:, 0], [4.5, 5.5])
    assert scene.models == [second]
    assert len(scene.transforms) == 2
    third = scene.add(box, Transform((9, 0, 0)))
    assert_allclose(scene.bounds()[:, 0], [4.5, 9.5])
    assert scene.models == [second, third]


def test_a_removed_model_cannot_be_used(scene: Scene, box: Model) -> None:
    model = scene.add(box)
    model.remove()
    with pytest.raises(OptionError, match="was removed"):
        model.transform.translate((1, 0, 0))
    with pytest.raises(OptionError, match="not added to this scene"):
        model.remove()


def test_what_hung_on_a_removed_model_stays_in_place(
    scene: Scene, box: Model
) -> None:
    model = scene.add(box, Transform((1, 0, 0)))
    rider = scene.add(box, Transform((2, 0, 0)))
    rider.transform.set_parent(model.node(0))
    camera = Camera(transform=Transform((0, 0, 4)))
    camera.transform.set_parent(model.transform)
    model.remove()
    assert_allclose(camera.position, [1, 0, 4])
    assert_allclose(scene.bounds()[:, 0], [2.5, 3.5])


def test_cameras_stand_at_their_nodes(scene: Scene) -> None:
    described = CameraDescription(Perspective(0.7), "front")
    unnamed = CameraDescription(Perspective(0.9))
    model = make_model(
        [1],
        [0, -1, -1],
        [-1, -1, -1],
        cameras={1: described, 2: unnamed},
        names=["mesh", "one", "two"],
    )
    model.nodes.local[:, :3, :3] = np.eye(3)
    added = scene.add(model, Transform((0, 0, 10)))
    assert [camera.name for camera in scene.cameras] == ["front", "two"]
    expected = model.nodes.local[1, :3, 3] + (0, 0, 10)
    assert_allclose(added.cameras[0].position, expected)


def test_lights_stand_at_their_nodes_and_anywhere(scene: Scene) -> None:
    model = make_model([1], [0, -1], [-1, 0], lights={1: POINT})
    scene.add(model, Transform((1, 0, 0)))
    added = scene.add_light(POINT, Transform((0, 7, 0)))
    scene.update()
    rows = scene.light_rows(origin=(0, 1, 0))
    world = model.nodes.world_matrices()[1, :3, 3]
    expected = np.add(world, (1, -1, 0))
    assert_allclose(rows["position"][0], expected, rtol=1e-6)
    assert_allclose(rows["position"][1], [0, 6, 0])
    added.visible = False
    assert len(scene.light_rows()) == 1
    scene.remove(added)
    assert len(scene.lights) == 1
    with pytest.raises(OptionError, match="not added"):
        scene.remove(added)
    with pytest.raises(OptionError, match="not added"):
        scene.remove(scene.lights[0])


def test_a_light_at_a_model_leaves_it_whole(scene: Scene, box: Model) -> None:
    model = scene.add(box)
    light = scene.add_light(POINT, model.transform)
    scene.remove(light)
    model.transform.position = (2, 0, 0)
    assert_allclose(scene.bounds()[:, 0], [1.5, 2.5])


def test_a_light_at_a_model_goes_with_it(scene: Scene, box: Model) -> None:
    model = scene.add(box)
    scene.add_light(POINT, model.node(0))
    other = scene.add_light(POINT)
    model.remove()
    scene.update()
    assert scene.lights == [other]
    assert len(scene.light_rows()) == 1


def test_nodes_by_name_and_number(scene: Scene) -> None:
    model = scene.add(
        make_model([1], [0, 0, 0], [-1, 0, 1], names=["a", "b", "b"])
    )
    assert model.node("a") is model.node(0)
    assert model.node(1).parent is model.node("a")
    assert model.node("a").parent is model.transform
    for wrong in ("c", "b", 3, -1):
        with pytest.raises(OptionError, match="scene: "):
            model.node(wrong)


def test_a_scene_of_the_file_can_be_chosen(scene: Scene) -> None:
    model = make_model([1, 2], [0, 1], [-1, -1], lights={0: POINT})
    model.scenes = [[0], [1]]
    model.scene_names = ["", ""]
    scene.add(model, scene=1)
    scene.update()
    assert len(scene.drawables) == 2
    assert scene.lights == []
    with pytest.raises(ModelError, match="no scene 2"):
        scene.add(model, scene=2)


def test_models_may_be_empty(scene: Scene) -> None:
    scene.add(make_model([], [], []))
    assert scene.bounds() is None


def test_only_what_the_camera_sees_is_visible(scene: Scene, box: Model) -> None:
    for z in (-5, 5):
        scene.add(box, Transform((0, 0, z)))
    scene.update()
    assert scene.visible(Camera(), 1.0).tolist() == [True, False]
    scene.models[0].visible = False
    scene.update()
    assert scene.visible(Camera(), 1.0).tolist() == [False, False]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("environment", "environment"),
        ("transparent", "transparent"),
        ("#ff0000", (1, 0, 0)),
        ((0.25, 2, 0), (0.25, 2, 0)),
        (np.array([0, 0, 1]), (0, 0, 1)),
    ],
)
def test_backgrounds(scene: Scene, value: object, expected: object) -> None:
    scene.background = value
    assert scene.background == expected


@pytest.mark.parametrize(
    "value", ["blue", "#12345", "", (1, 2), (1, -1, 0), (1, np.nan, 0), None, 5]
)
def test_backgrounds_without_meaning(scene: Scene, value: object) -> None:
    with pytest.raises(OptionError):
        scene.background = value
    assert scene.background == "environment"


def test_many_copies_move_by_their_handles(box: Model) -> None:
    scene = Scene()
    models: list[SceneModel] = [scene.add(box) for _ in range(300)]
    for x, model in enumerate(models):
        model.transform.position = (x, 0, 0)
    assert_allclose(scene.bounds()[:, 0], [-0.5, 299.5])


@pytest.mark.assets
def test_bounds_of_a_real_model_are_those_of_its_file(assets: Path) -> None:
    from moka.model.load import load_model

    path = assets / "models" / "DamagedHelmet" / "DamagedHelmet.gltf"
    model = load_model(path)
    scene = Scene()
    scene.add(model)
    assert_allclose(scene.bounds(), model.bounds(), atol=1e-6)


def test_no_graphics_and_no_pyglm_are_imported() -> None:
    code = (
        "import sys, moka.scene.camera_choice, moka.scene.scene as s;"
        "s.Scene().bounds();"
        "assert not {'pyglm', 'moderngl', 'PIL'} & sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
