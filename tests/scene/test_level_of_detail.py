"""MSFT_lod: the level of each object against a scalar oracle."""

import math
from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model import Model, load_model
from moka.model.cameras import Orthographic, Perspective
from moka.scene.camera import Camera
from moka.scene.level_of_detail import screen_coverage
from moka.scene.scene import Scene
from moka.scene.transform import Transform
from tests.support.gltf_file import GltfFile

LIMITS = [0.5, 0.2, 0.01]


def chain(
    file: GltfFile, places: list[list[float]], limits: Any = None
) -> None:
    """A node of three levels at each place; sizes 1, 0.8 and 0.6."""
    meshes = [file.quad(size) for size in (1.0, 0.8, 0.6)]
    for place in places:
        first = len(file.document["nodes"])
        file.node(
            mesh=meshes[0],
            translation=place,
            extensions={"MSFT_lod": {"ids": [first + 1, first + 2]}},
            extras={"MSFT_screencoverage": limits or LIMITS},
        )
        file.node(mesh=meshes[1], translation=place)
        file.node(mesh=meshes[2], translation=place)


def oracle(centre: Any, radius: float, camera: Camera, aspect: float) -> float:
    """The covered share, by the angle under which the sphere is seen."""
    lens = camera.projection
    if isinstance(lens, Orthographic):
        width, height = 2 * lens.xmag, 2 * lens.ymag
        return min(1.0, math.pi * radius**2 / (width * height))
    distance = math.dist(centre, camera.position)
    if distance <= radius:
        return 1.0
    height = 2 * math.tan(lens.yfov / 2)
    across = math.tan(math.asin(radius / distance))
    return min(1.0, math.pi * across**2 / (height * height * aspect))


def expected_level(covered: float, limits: list[float]) -> int | None:
    for level, limit in enumerate(limits):
        if covered >= limit:
            return level
    return None


@pytest.mark.parametrize(
    "lens",
    [Perspective(0.8, 0.01), Orthographic(xmag=2, ymag=1.25, near=0, far=999)],
)
def test_coverage_is_that_of_the_sphere_around_the_box(lens: Any) -> None:
    random = np.random.default_rng(6)
    camera = Camera(lens, Transform((1, 2, 3), (0.1, 0.2, 0.3, 0.9)))
    least = random.normal(scale=4, size=(500, 3))
    greatest = least + random.exponential(size=(500, 3))
    got = screen_coverage(least, greatest, camera, 1.6)
    wanted = [
        oracle((a + b) / 2, float(np.linalg.norm(b - a) / 2), camera, 1.6)
        for a, b in zip(least, greatest, strict=True)
    ]
    assert got == pytest.approx(wanted, rel=1e-12)
    assert (got == 1).any()


def levels_shown(model: Model, camera: Camera, aspect: float) -> set[int]:
    """Nodes of the file that are drawn."""
    scene = Scene()
    placed = scene.add(model)
    scene.update()
    visible = scene.visible(camera, aspect)
    rows = placed.layout.node[visible]
    return set(model.nodes.source[rows].tolist())


def test_each_node_shows_the_level_of_its_coverage() -> None:
    random = np.random.default_rng(8)
    places = [
        [float(x), float(y), float(-z)]
        for x, y, z in np.stack(
            [
                random.uniform(-0.1, 0.1, 60),
                random.uniform(-0.1, 0.1, 60),
                random.geometric(0.07, 60) * random.uniform(0.5, 1.0, 60),
            ],
            axis=1,
        )
    ]
    file = GltfFile()
    chain(file, places)
    model = load_model(file.glb())
    assert model.unsupported_extensions == ()
    camera = Camera(Perspective(0.9, 0.01))
    wanted = set()
    counts = {0: 0, 1: 0, 2: 0, None: 0}
    for number, place in enumerate(places):
        covered = oracle(place, math.sqrt(0.5), camera, 1.5)
        level = expected_level(covered, LIMITS)
        counts[level] += 1
        if level is not None:
            wanted.add(3 * number + level)
    assert all(counts.values()), counts
    assert levels_shown(model, camera, 1.5) == wanted


@pytest.mark.parametrize(
    ("extras", "level"),
    [
        (None, 0),
        ("far", 0),
        ({"MSFT_screencoverage": "near"}, 0),
        ({"MSFT_screencoverage": [0.5]}, 1),
        ({"MSFT_screencoverage": [0.5, 0.2, 0.1]}, None),
        ({"MSFT_screencoverage": [0.5, 0.2, 0.0, 0.7]}, 2),
        ({"MSFT_screencoverage": [7, -3]}, 1),
    ],
)
def test_hints_that_are_short_or_none(extras: Any, level: int | None) -> None:
    """A quad that is hardly seen, with what ``extras`` say of it."""
    file = GltfFile()
    chain(file, [[0, 0, -100]])
    if extras is None:
        del file.document["nodes"][0]["extras"]
    else:
        file.document["nodes"][0]["extras"] = extras
    shown = levels_shown(load_model(file.glb()), Camera(), 1.0)
    assert shown == (set() if level is None else {level})


def test_levels_stand_where_the_finest_does() -> None:
    """With its parent, and in its scene, unless they have a parent."""
    file = GltfFile()
    chain(file, [[0, 0, 0]])
    file.node(children=[0], translation=[0, 0, -100])
    file.document["scenes"] = [{"nodes": [3]}]
    model = load_model(file.glb())
    rows = model.nodes.rows_of_file()
    above = model.nodes.parents[rows[:3]]
    assert above.tolist() == [rows[3]] * 3
    assert levels_shown(model, Camera(), 1.0) == set()
    file.document["nodes"][0]["extras"]["MSFT_screencoverage"] = [0.5, 1e-9]
    assert levels_shown(load_model(file.glb()), Camera(), 1.0) == {1}
    # A root is one of its scene, and so are its levels.
    file.document["nodes"][3] = {}
    for node in file.document["nodes"][:3]:
        node["translation"] = [0, 0, -100]
    file.document["scenes"] = [{"nodes": [0]}]
    assert levels_shown(load_model(file.glb()), Camera(), 1.0) == {1}


def test_levels_of_levels_are_shown_where_both_are() -> None:
    """The finest level of the outer group holds a group of its own."""
    file = GltfFile()
    chain(file, [[0, 0, 0]], [0.3, 0.0])
    file.node(
        children=[0],
        extensions={"MSFT_lod": {"ids": [4]}},
        extras={"MSFT_screencoverage": [0.1, 0.0]},
    )
    file.node(mesh=0)
    file.document["scenes"] = [{"nodes": [3]}]
    model = load_model(file.glb())
    seen = []
    for distance in (1.1, 3.0, 8.0):
        camera = Camera(Perspective(0.9, 0.01), Transform((0, 0, distance)))
        covered = oracle((0, 0, 0), math.sqrt(0.5), camera, 1.0)
        outer = expected_level(covered, [0.1, 0.0])
        inner = expected_level(covered, [0.3, 0.0])
        wanted = {4} if outer else {inner}
        assert levels_shown(model, camera, 1.0) == wanted
        seen.append(wanted)
    assert seen == [{0}, {1}, {4}]


def test_materials_have_levels_of_their_own() -> None:
    """Per object: near and far copies of one mesh differ."""
    file = GltfFile()
    near, far = file.unlit(1, 0, 0, 1), file.unlit(0, 1, 0, 1)
    file.document["materials"][near]["extensions"]["MSFT_lod"] = {"ids": [far]}
    file.document["materials"][near]["extras"] = {
        "MSFT_screencoverage": [0.2, 0.0]
    }
    mesh = file.quad(material=near)
    file.node(mesh=mesh, translation=[0, 0, -1])
    file.node(mesh=mesh, translation=[0, 0, -50])
    scene = Scene()
    scene.add(load_model(file.glb()))
    scene.update()
    drawables = scene.drawables
    assert len(drawables) == 4
    visible = np.flatnonzero(scene.visible(Camera(), 1.0))
    materials = [
        drawables.primitives[drawables.primitive[draw]].material
        for draw in visible
    ]
    assert [each.base_colour_factor for each in materials if each] == [
        (1, 0, 0, 1),
        (0, 1, 0, 1),
    ]
    # Copies of the model add groups, and none is mixed up.
    scene.add(load_model(file.glb()), np.eye(4))
    scene.update()
    both = scene.visible(Camera(), 1.0)
    assert both[:4].tolist() == both[4:].tolist()
    assert both.sum() == 4


def test_without_levels_nothing_is_decided() -> None:
    file = GltfFile()
    file.node(mesh=file.quad(material=file.unlit(1, 1, 1, 1)))
    scene = Scene()
    scene.add(load_model(file.glb()))
    scene.update()
    assert scene.drawables.levels is None


def test_narrowing_forgets_what_is_not_seen() -> None:
    file = GltfFile()
    chain(file, [[0, 0, -1], [0, 0, -9], [0, 0, 5]])
    model = load_model(file.glb())
    scene = Scene()
    scene.add(model)
    camera = Camera()
    scene.update()
    visible = np.flatnonzero(scene.visible(camera, 1.0))
    primitives = {
        id(scene.drawables.primitives[index])
        for index in scene.drawables.primitive[visible]
    }
    objects = scene.drawables.object[visible].tolist()
    scene.narrow(camera, 1.0)
    scene.update()
    narrowed = scene.drawables
    assert narrowed.object.tolist() == objects
    assert narrowed.total == 9
    assert {id(each) for each in narrowed.primitives} == primitives
    assert scene.visible(camera, 1.0).all()
    # What comes later brings the rest back.
    scene.add(model)
    scene.update()
    assert len(scene.drawables) == 18


@pytest.mark.parametrize(
    ("ids", "message"),
    [
        ([], "nodes[0].extensions.MSFT_lod.ids: "),
        ([7], "nodes[0].extensions.MSFT_lod.ids[0]: there is no nodes[7]"),
        ([1, 1], "nodes[1]: is two levels of MSFT_lod"),
        ([0], "nodes[0]: is two levels of MSFT_lod"),
    ],
)
def test_says_what_is_wrong(ids: list[int], message: str) -> None:
    file = GltfFile()
    mesh = file.quad()
    file.node(mesh=mesh, extensions={"MSFT_lod": {"ids": ids}})
    file.node(mesh=mesh)
    with pytest.raises(ModelError) as caught:
        load_model(file.glb())
    assert message in str(caught.value)
