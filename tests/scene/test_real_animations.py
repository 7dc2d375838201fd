"""Animations of real models, against the oracle and pygltflib's reading."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
import pytest

from moka.model import load_model
from moka.scene.scene import Scene
from tests.model.test_sample_models import elements
from tests.support.oracles.keyframes import sample

pytestmark = pytest.mark.assets

NAMES = [
    "CesiumMilkTruck.glb",
    "Michelle.glb",
    "MorphStressTest.gltf",
    "Soldier.glb",
]
REST = {
    "translation": (0, 0, 0),
    "rotation": (0, 0, 0, 1),
    "scale": (1, 1, 1),
}


class Oracle:
    """A file's nodes at one moment, walked one by one."""

    def __init__(self, path: Path) -> None:
        loaded = pygltflib.GLTF2.load(str(path))
        assert loaded is not None
        self.gltf: Any = loaded
        self.elements = cache(lambda index: elements(loaded, index))

    def moved(self, animation: Any, time: float) -> dict[Any, Any]:
        """What the channels move, by node and path."""
        values = {}
        for channel in animation.channels:
            sampler = animation.samplers[channel.sampler]
            times = self.elements(sampler.input)[:, 0].tolist()
            keys = self.elements(sampler.output)
            path = channel.target.path
            values[channel.target.node, path] = sample(
                times,
                keys.reshape(len(times), -1),
                sampler.interpolation,
                time,
                rotates=path == "rotation",
            )
        return values

    def local(self, index: int, moved: dict[Any, Any]) -> Any:
        node = self.gltf.nodes[index]
        if node.matrix is not None:
            return np.reshape(node.matrix, (4, 4)).T
        translation, rotation, scale = (
            np.asarray(
                moved.get((index, name), getattr(node, name) or REST[name]),
                np.float64,
            )
            for name in REST
        )
        x, y, z, w = rotation / np.linalg.norm(rotation)
        cross = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
        matrix = np.eye(4)
        turn = np.eye(3) + 2 * w * cross + 2 * cross @ cross
        matrix[:3, :3] = turn @ np.diag(scale)
        matrix[:3, 3] = translation
        return matrix


@pytest.mark.parametrize("name", NAMES)
def test_every_animation_agrees_with_the_oracle(
    assets: Path, name: str
) -> None:
    path = assets / "models" / name
    oracle = Oracle(path)
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
