"""Playing animations: clocks, blends, and what a still pose costs."""

import numpy as np
import pytest

from moka.core.errors import OptionError
from moka.core.maths import compose
from moka.model import load_model
from moka.scene.scene import Scene
from moka.scene.scene_model import SceneModel
from tests.support.animated import AnimatedFile

QUARTER = float(np.sqrt(0.5))
IDENTITY = (0.0, 0.0, 0.0, 1.0)


def moving_file() -> AnimatedFile:
    """Two nodes: "slide" moves both, "turn" turns the second."""
    file = AnimatedFile(2)
    file.document["nodes"][1] |= {
        "translation": [0, 0, 5],
        "scale": [-1, 1, 1],
    }
    ends = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0)]
    file.channel((0, "translation"), [0, 2], ends, animation="slide")
    file.channel((1, "translation"), [0, 2], ends, animation="slide")
    file.channel(
        (1, "rotation"),
        [0, 1],
        [IDENTITY, (0, QUARTER, 0, QUARTER)],
        animation="turn",
    )
    return file


@pytest.fixture
def scene() -> Scene:
    return Scene()


@pytest.fixture
def model(scene: Scene) -> SceneModel:
    return scene.add(load_model(moving_file().glb()))


def x_of(scene: Scene, model: SceneModel, node: int = 0) -> float:
    scene.update()
    return float(scene.transforms.world[model.rows[node], 0, 3])


def test_nothing_plays_by_itself(scene: Scene, model: SceneModel) -> None:
    scene.animate(1.0)
    assert model.animations.current is None
    assert not model.animations.is_playing
    scene.animate(1.0)
    assert x_of(scene, model) == 0


def test_time_passes_with_animate(scene: Scene, model: SceneModel) -> None:
    model.animations.play("slide")
    scene.animate(0.5)
    assert x_of(scene, model) == 1
    scene.animate(0.25)
    assert x_of(scene, model) == 1.5


def test_a_node_keeps_what_the_animation_does_not_move(
    scene: Scene, model: SceneModel
) -> None:
    model.animations.play("turn")
    scene.animate(0.5)
    scene.update()
    half = np.deg2rad(45) / 2
    np.testing.assert_allclose(
        scene.transforms.world[model.rows[1]],
        compose((0, 0, 5), (0, np.sin(half), 0, np.cos(half)), (-1, 1, 1)),
        atol=1e-7,
    )


def test_a_loop_goes_around(scene: Scene, model: SceneModel) -> None:
    playing = model.animations.play("slide", loop=True)
    scene.animate(2.5)
    assert playing.time == 0.5
    assert x_of(scene, model) == 1
    assert model.animations.is_playing
    assert scene.is_animating


def test_without_a_loop_it_stays_at_the_end(
    scene: Scene, model: SceneModel
) -> None:
    playing = model.animations.play("slide", loop=False)
    scene.animate(9.0)
    assert playing.time == 2
    assert playing.has_ended
    assert not model.animations.is_playing
    assert not scene.is_animating
    assert x_of(scene, model) == 4


def test_speed_scales_time_and_may_be_negative(
    scene: Scene, model: SceneModel
) -> None:
    playing = model.animations.play("slide", speed=2.0)
    scene.animate(0.5)
    assert x_of(scene, model) == 2
    playing.speed = -1.0
    scene.animate(0.25)
    assert x_of(scene, model) == 1.5
    scene.animate(1.0)  # Around the start to the end.
    assert playing.time == 1.75


def test_a_pause_holds_the_pose(scene: Scene, model: SceneModel) -> None:
    player = model.animations
    player.play("slide")
    scene.animate(0.5)
    player.pause()
    scene.animate(0.5)
    assert x_of(scene, model) == 1
    assert not player.is_playing
    player.resume()
    scene.animate(0.5)
    assert x_of(scene, model) == 2


def test_seek_shows_at_the_next_update(scene: Scene, model: SceneModel) -> None:
    model.animations.play("slide")
    model.animations.seek(1.5)
    assert x_of(scene, model) == 3


def test_stop_returns_to_the_pose_of_the_file(
    scene: Scene, model: SceneModel
) -> None:
    scene.update()
    before = scene.transforms.world.copy()
    model.animations.pose("slide", 1.0)
    assert x_of(scene, model) == 2
    model.animations.stop()
    scene.update()
    np.testing.assert_array_equal(scene.transforms.world, before)


@pytest.mark.parametrize(("time", "x"), [(-3.0, 0), (1.0, 2), (99.0, 4)])
def test_a_pose_is_held_and_has_ends(
    scene: Scene, model: SceneModel, time: float, x: float
) -> None:
    model.animations.pose("slide", time)
    scene.animate(0.5)
    assert x_of(scene, model) == x


def test_two_animations_blend_by_weight(
    scene: Scene, model: SceneModel
) -> None:
    player = model.animations
    slide, turn = player.blend("slide", "turn", 0.25)
    slide.time = turn.time = 1.0
    scene.update()
    # The first moves a node that the second leaves at rest.
    assert x_of(scene, model, 0) == 2 * 0.75
    half = np.deg2rad(90 * 0.25) / 2
    np.testing.assert_allclose(
        scene.transforms.world[model.rows[1]],
        compose(
            (2 * 0.75, 0, 5 * 0.25),
            (0, np.sin(half), 0, np.cos(half)),
            (-1, 1, 1),
        ),
        atol=1e-7,
    )
    player.blend("slide", "turn", 1.0)
    assert slide.time == 1.0
    assert x_of(scene, model, 0) == 0
    player.blend("slide", "turn", 0.0)
    assert x_of(scene, model, 0) == 2


def test_a_fade_goes_from_one_pose_to_the_other(
    scene: Scene, model: SceneModel
) -> None:
    player = model.animations
    player.pose("slide", 2.0)
    playing = player.play("turn", fade=2.0)
    seen = []
    for _ in range(5):
        seen.append(x_of(scene, model))
        scene.animate(0.5)
    np.testing.assert_allclose(seen, [4, 3, 2, 1, 0], atol=1e-12)
    assert playing.weight == 1
    assert player.current is playing


def test_a_third_animation_fades_in_without_a_jump(
    scene: Scene, model: SceneModel
) -> None:
    player = model.animations
    player.pose("slide", 2.0)
    player.play("turn", fade=1.0)
    scene.animate(0.5)
    before = x_of(scene, model)
    player.play("slide", fade=1.0, speed=0.0, start=2.0)
    assert x_of(scene, model) == before == 2
    scene.animate(1.0)
    assert x_of(scene, model) == 4


def test_the_same_steps_give_the_same_poses() -> None:
    worlds = []
    for _ in range(2):
        scene = Scene()
        model = scene.add(load_model(moving_file().glb()))
        model.animations.play("slide")
        for frame in range(100):
            if frame == 30:
                model.animations.play("turn", fade=0.5)
            scene.animate(1 / 60)
        scene.update()
        worlds.append(scene.transforms.world.copy())
    np.testing.assert_array_equal(*worlds)


def test_copies_play_on_their_own(scene: Scene) -> None:
    model = load_model(moving_file().glb())
    first, second = scene.add(model), scene.add(model)
    first.animations.play("slide")
    second.animations.play("slide", start=1.0)
    assert first.layout is second.layout
    scene.animate(0.5)
    assert (x_of(scene, first), x_of(scene, second)) == (1, 3)


def test_a_crowd_moves_as_each_of_it_alone(scene: Scene) -> None:
    model = load_model(moving_file().glb())
    crowd = [scene.add(model) for _ in range(6)]
    crowd.append(scene.add(model))
    crowd[2].animations.play("turn")
    crowd.pop(2).remove()  # Its place goes to the next.
    crowd.append(scene.add(model))

    def start(copy: SceneModel, index: int) -> None:
        player = copy.animations
        if index % 3 == 2:
            player.blend("slide", "turn", 0.3, speed=1 + 0.1 * index)
        else:
            player.play(index % 2, start=0.1 * index, loop=index != 4)

    for index, copy in enumerate(crowd):
        start(copy, index)
    for _ in range(9):
        scene.animate(0.13)
    scene.update()
    for index, copy in enumerate(crowd):
        alone = Scene()
        other = alone.add(model)
        start(other, index)
        for _ in range(9):
            alone.animate(0.13)
        alone.update()
        np.testing.assert_allclose(
            scene.transforms.world[copy.rows],
            alone.transforms.world[other.rows],
            atol=1e-15,
        )


def test_a_still_pose_costs_nothing(scene: Scene, model: SceneModel) -> None:
    player = model.animations
    player.pose("slide", 1.0)
    scene.update()
    version = scene.transforms.version
    edits = scene.transforms.edits(int(model.rows[0]))
    for _ in range(3):
        scene.animate(0.1)
        player.pose("slide", 1.0)
        scene.update()
    player.play("slide", loop=False, start=1.0)
    player.pause()
    scene.animate(0.1)
    scene.update()
    assert scene.transforms.version == version
    assert scene.transforms.edits(int(model.rows[0])) == edits


def test_only_nodes_that_move_are_written(
    scene: Scene, model: SceneModel
) -> None:
    model.animations.pose("turn", 0.5)
    scene.update()
    still, turned = (scene.transforms.edits(int(row)) for row in model.rows)
    model.animations.pose("turn", 0.75)
    scene.update()
    assert scene.transforms.edits(int(model.rows[0])) == still
    assert scene.transforms.edits(int(model.rows[1])) == turned + 1


def test_what_an_app_moves_after_the_animation_stays_moved(
    scene: Scene, model: SceneModel
) -> None:
    model.animations.play("slide")
    scene.animate(0.5)
    model.node(0).position = (7, 0, 0)
    assert x_of(scene, model) == 7
    scene.animate(0.5)
    assert x_of(scene, model) == 2


def test_weights_are_written_where_the_renderer_reads(scene: Scene) -> None:
    file = AnimatedFile(2)
    file.morph_targets(2)
    file.document["meshes"][0]["weights"] = [0.25, 0.75]
    file.channel((1, "weights"), [0, 1], [0.0, 1.0, 1.0, 0.0])
    model = scene.add(load_model(file.glb()))
    weights = model.morph_weights
    assert weights is not None
    model.animations.pose(0, 0.25)
    scene.update()
    np.testing.assert_array_equal(weights.values, [0.25, 0.75, 0.25, 0.75])
    model.animations.pose(0, 1.0)
    scene.update()
    np.testing.assert_array_equal(weights.values, [0.25, 0.75, 1, 0])
    version = weights.version
    scene.animate(1.0)
    scene.update()
    assert weights.version == version


def test_lights_and_cameras_follow_pointers(scene: Scene) -> None:
    light = {"type": "point", "intensity": 2, "color": [1, 0.5, 0]}
    file = AnimatedFile(
        2,
        cameras=[
            {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}
        ],
        extensions={"KHR_lights_punctual": {"lights": [light]}},
    )
    for node in file.document["nodes"]:
        node["extensions"] = {"KHR_lights_punctual": {"light": 0}}
        node["camera"] = 0
    lights = "/extensions/KHR_lights_punctual/lights/0"
    file.channel(f"{lights}/intensity", [0, 1], [2.0, 6.0])
    file.channel(f"{lights}/color", [0, 1], [(1.0, 0, 0), (0, 0, 1.0)])
    file.channel(f"{lights}/range", [0, 1], [8.0, 16.0])
    file.channel("/cameras/0/perspective/yfov", [0, 1], [0.5, 1.0])
    model = scene.add(load_model(file.glb()))
    model.animations.pose(0, 0.5)
    scene.update()
    for each in model.lights:
        assert each.description.intensity == 4
        assert each.description.colour == (0.5, 0, 0.5)
        assert each.description.range == 12
    assert [each.projection.yfov for each in model.cameras] == [0.75, 0.75]
    model.animations.stop()
    scene.update()
    assert model.lights[0].description.colour == (1, 0.5, 0)


def test_materials_keep_what_a_person_changed(scene: Scene) -> None:
    file = AnimatedFile()
    pointer = "/materials/0/pbrMetallicRoughness/baseColorFactor"
    file.channel(pointer, [0, 1], [(0.0, 0, 0, 1), (1.0, 0.5, 0, 1)])
    model = scene.add(load_model(file.glb()))
    (own,) = model.own_materials.values()
    scene.edit_material(own, roughness_factor=0.25)
    model.animations.pose(0, 0.5)
    scene.update()
    now = scene.material_now(own)
    assert now.base_colour_factor == (0.5, 0.25, 0, 1)
    assert now.roughness_factor == 0.25


@pytest.mark.parametrize("name", ["Run", 2, -1, "2"])
def test_an_unknown_animation_is_told_with_what_there_is(
    model: SceneModel, name: str | int
) -> None:
    with pytest.raises(OptionError, match=r"0 'slide', 1 'turn'$"):
        model.animations.play(name)


def test_a_model_without_animations_has_none(scene: Scene) -> None:
    model = scene.add(load_model(AnimatedFile().glb()))
    assert model.animations.names == []
    with pytest.raises(OptionError, match="the model has none"):
        model.animations.play()


def test_names_go_before_positions(scene: Scene) -> None:
    file = AnimatedFile()
    for index, name in enumerate(("1", "x")):
        file.channel(
            (0, "translation"),
            [0],
            [(float(index), 0.0, 0.0)],
            animation=name,
        )
    player = scene.add(load_model(file.glb())).animations
    assert player.play("1").animation == 0
    assert player.play("0").animation == 0
    assert player.play(1).animation == 1


def test_values_that_mean_nothing_are_refused(model: SceneModel) -> None:
    player = model.animations
    for wrong in (
        lambda: player.play(0, speed=float("nan")),
        lambda: player.play(0, start=float("inf")),
        lambda: player.play(0, fade=-1.0),
        lambda: player.blend(0, 1, 1.5),
        lambda: player.seek(1.0),
    ):
        with pytest.raises(OptionError, match=r"^animation: "):
            wrong()


def test_a_removed_model_is_not_animated(
    scene: Scene, model: SceneModel
) -> None:
    other = scene.add(model.model)
    model.animations.play("slide")
    for each in (model, other):
        each.remove()
    scene.animate(0.5)
    scene.update()
    assert len(scene.transforms) == 0
    # Its rows may be another's by now.
    with pytest.raises(OptionError, match="is not in this scene any more"):
        other.animations.play("slide")
