"""Animations of real models, against the oracle and pygltflib's reading."""

from pathlib import Path

import numpy as np
import pytest

from moka.model import load_model
from moka.scene.scene import Scene
from tests.support.oracles.gltf_file import FileOracle

pytestmark = pytest.mark.assets

NAMES = [
    "CesiumMilkTruck.glb",
    "Michelle.glb",
    "MorphStressTest.gltf",
    "Soldier.glb",
]


@pytest.mark.parametrize("name", NAMES)
def test_every_animation_agrees_with_the_oracle(
    assets: Path, name: str
) -> None:
    path = assets / "models" / name
    oracle = FileOracle(path)
    scene = Scene()
    model = scene.add(load_model(path))
    of_file = model.model.nodes.source.tolist()
    for number, animation in enumerate(oracle.gltf.animations):
        end = model.model.animations[number].duration
        for time in (0.0, 0.37 * end, 0.81 * end, end):
            moved = oracle.moved(animation, time)
            model.animations.pose(number, time)
            scene.update()
            local = scene.transforms.local[model.rows]
            for row, index in enumerate(of_file):
                np.testing.assert_allclose(
                    local[row], oracle.local(index, moved), atol=1e-9
                )
            for (index, what), values in moved.items():
                if what == "weights":
                    weights = model.morph_weights
                    assert weights is not None
                    place = weights.slice_of(of_file.index(index))
                    np.testing.assert_allclose(
                        weights.values[place], values, rtol=1e-6, atol=1e-7
                    )


def test_soldiers_animations_have_their_names(assets: Path) -> None:
    model = load_model(assets / "models" / "Soldier.glb")
    assert [each.name for each in model.animations] == [
        "Idle",
        "Run",
        "TPose",
        "Walk",
    ]
    assert [len(each.channels) for each in model.animations] == [156] * 4
