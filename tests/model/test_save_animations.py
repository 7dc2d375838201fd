"""Animations survive being saved and loaded again."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from moka.model import Model, load_model, save_model
from tests.model.test_animation_pointer import rich_file
from tests.support.animated import AnimatedFile


def saved(model: Model, folder: Path) -> Model:
    save_model(model, folder / "saved.glb")
    return load_model(folder / "saved.glb")


def assert_same_animations(first: Model, second: Model) -> None:
    assert len(first.animations) == len(second.animations)
    for one, other in zip(first.animations, second.animations, strict=True):
        assert one.name == other.name
        assert one.duration == other.duration
        assert len(one.channels) == len(other.channels)
        for mine, theirs in zip(one.channels, other.channels, strict=True):
            assert mine.target == theirs.target
            assert mine.interpolation == theirs.interpolation
            np.testing.assert_array_equal(mine.times, theirs.times)
            np.testing.assert_allclose(mine.values, theirs.values, rtol=2e-7)


def test_nodes_move_as_before(tmp_path: Path) -> None:
    file = AnimatedFile(2)
    file.morph_targets(2)
    file.document["nodes"][1] |= {
        "translation": [1, 2, 3],
        "rotation": [0, 1, 0, 0],
        "scale": [-1, 2, 1],
    }
    random = np.random.default_rng(0)
    times = file.accessor([0.0, 0.5, 2.0])
    file.channel((1, "translation"), times, random.normal(size=(3, 3)))
    file.channel((1, "rotation"), times, random.normal(size=(3, 4)), "STEP")
    file.channel((0, "scale"), times, random.normal(size=(9, 3)), "CUBICSPLINE")
    file.channel((1, "weights"), times, random.normal(size=6))
    file.channel((0, "weights"), times, random.normal(size=18), "CUBICSPLINE")
    model = load_model(file.glb())
    again = saved(model, tmp_path)
    assert_same_animations(model, again)
    assert model.rest_pose is not None
    assert again.rest_pose is not None
    for name in ("nodes", "translation", "rotation", "scale"):
        np.testing.assert_array_equal(
            getattr(model.rest_pose, name), getattr(again.rest_pose, name)
        )
    np.testing.assert_allclose(again.nodes.local, model.nodes.local)
    # Channels that shared their times still do.
    assert len({id(c.times) for c in again.animations[0].channels}) == 1


@pytest.mark.parametrize(
    ("pointer", "values"),
    [
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", np.eye(4)[:2]),
        ("/materials/0/emissiveFactor", [(1.0, 0.5, 0.25), (0.0, 0.0, 2.0)]),
        ("/cameras/0/perspective/zfar", [10.0, 20.0]),
        ("/cameras/1/orthographic/ymag", [1.0, 2.0]),
        (
            "/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle",
            [0.1, 0.2],
        ),
        ("/nodes/1/weights/1", [0.25, 0.75]),
    ],
)
def test_what_pointers_name_moves_as_before(
    tmp_path: Path, pointer: str, values: list[float]
) -> None:
    file = rich_file()
    file.channel(pointer, [0, 1], values)
    model = load_model(file.glb())
    assert model.animations[0].channels
    assert_same_animations(model, saved(model, tmp_path))


def test_emission_keeps_factor_and_strength_apart(tmp_path: Path) -> None:
    file = rich_file()
    file.channel("/materials/0/emissiveFactor", [0], [(1.0, 0.5, 0.25)])
    for pointer, values in (
        ("emissiveFactor", [(0.5, 0.5, 0.5)]),
        ("extensions/KHR_materials_emissive_strength/emissiveStrength", [2.0]),
    ):
        file.channel(f"/materials/0/{pointer}", [0], values, animation="both")
    model = load_model(file.glb())
    assert_same_animations(model, saved(model, tmp_path))


def test_without_a_rest_pose_matrices_are_taken_apart(tmp_path: Path) -> None:
    file = AnimatedFile()
    file.document["nodes"][0]["scale"] = [1, 2, 3]
    file.channel((0, "translation"), [0], [(1.0, 2.0, 3.0)])
    model = replace(load_model(file.glb()), rest_pose=None)
    again = saved(model, tmp_path)
    assert again.rest_pose is not None
    np.testing.assert_allclose(again.rest_pose.scale, [(1, 2, 3)])


@pytest.mark.assets
@pytest.mark.parametrize(
    "name", ["Soldier.glb", "MorphStressTest.gltf", "CesiumMilkTruck.glb"]
)
def test_real_animations_survive(
    tmp_path: Path, assets: Path, name: str
) -> None:
    model = load_model(assets / "models" / name)
    assert_same_animations(model, saved(model, tmp_path))
