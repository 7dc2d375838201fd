"""KHR_node_visibility: what is hidden hides all that is below it."""

import numpy as np

from moka.model import load_model
from moka.model.lights import LightKind, PunctualLight
from moka.scene.scene import Scene
from moka.scene.transform import Transform
from moka.scene.transforms import TransformTree
from tests.scene.models import make_model
from tests.support.gltf_file import GltfFile

LIGHT = PunctualLight(LightKind.POINT)


def test_a_row_is_hidden_with_all_below_it() -> None:
    """Against a walk up from every row."""
    random = np.random.default_rng(4)
    tree = TransformTree()
    count = 200
    parents = np.array([random.integers(-1, row) for row in range(count)])
    rows = tree.add_many(np.tile(np.eye(4), (count, 1, 1)), parents)
    own = random.random(count) < 0.05
    tree.set_visible(rows, ~own)
    walked = own.copy()
    for row in range(count):
        above = parents[row]
        while above >= 0:
            walked[row] |= own[above]
            above = parents[above]
    assert 0 < own.sum() < walked.sum() < count
    assert tree.hidden()[rows].tolist() == walked.tolist()


def test_a_file_says_what_is_hidden() -> None:
    file = GltfFile()
    mesh = file.quad()
    hidden = {"KHR_node_visibility": {"visible": False}}
    shown = {"KHR_node_visibility": {"visible": True}}
    file.node(mesh=mesh, children=[1], extensions=hidden)
    file.node(mesh=mesh, extensions=shown)
    file.node(mesh=mesh, extensions={"KHR_node_visibility": {}})
    model = load_model(file.glb())
    assert model.unsupported_extensions == ()
    scene = Scene()
    placed = scene.add(model)
    scene.update()
    assert dict(
        zip(
            model.nodes.source[placed.layout.node].tolist(),
            scene.shown.tolist(),
            strict=True,
        )
    ) == {0: False, 1: False, 2: True}
    # Switched at run time, at the node of the file.
    node = placed.node(int(model.nodes.rows_of_file()[0]))
    assert not node.visible
    version = scene.visibility_version
    node.visible = True
    scene.update()
    assert scene.shown.all()
    assert scene.visibility_version > version


def test_lights_go_out_with_their_node_but_cameras_stay() -> None:
    scene = Scene()
    model = scene.add(make_model([1], [0, -1], [-1, 0], lights={1: LIGHT}))
    scene.update()
    assert len(scene.light_rows()) == 1
    model.node(0).visible = False
    scene.update()
    assert len(scene.light_rows()) == 0
    assert not scene.shown.any()
    assert scene.bounds() is None


def test_a_transform_above_models_hides_them() -> None:
    group = Transform()
    scene = Scene()
    first = scene.add(make_model([1], [0], [-1]))
    scene.add(make_model([1], [0], [-1]))
    first.transform.set_parent(group)
    group.visible = False
    scene.update()
    assert scene.shown.tolist() == [False, True]
    first.transform.set_parent(None)
    scene.update()
    assert scene.shown.tolist() == [True, True]


def test_a_removed_row_is_not_remembered() -> None:
    scene = Scene()
    model = scene.add(make_model([1], [0], [-1]))
    model.node(0).visible = False
    scene.update()
    model.remove()
    again = scene.add(make_model([1], [0], [-1]))
    scene.update()
    assert again.node(0).visible
    assert scene.shown.tolist() == [True]


def test_without_marks_nothing_changes_version() -> None:
    scene = Scene()
    scene.add(make_model([1], [0], [-1]))
    version = scene.transforms.hidden_version
    scene.transforms.add()
    assert scene.transforms.hidden_version == version
