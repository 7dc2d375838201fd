"""The weights of morph targets in a scene, and when they count as new."""

import numpy as np
import pytest

from moka.core.errors import OptionError
from moka.model.mesh import Mesh
from moka.scene.morph_weights import MorphWeights
from moka.scene.scene import Scene
from tests.scene.models import make_model


def morphed() -> MorphWeights:
    """Nodes with 2 targets, no mesh, 3 targets, no targets, 2 targets."""
    model = make_model([1, 1, 1], [0, -1, 1, 2, 0], [-1, 0, 0, 0, 1])
    model.meshes = [
        Mesh("", model.meshes[0].primitives, [0.5, -1], 2),
        Mesh("", model.meshes[1].primitives, [], 3),
        model.meshes[2],
    ]
    model.nodes.weights = {4: [0.25, 2]}
    weights = Scene().add(model).morph_weights
    assert weights is not None
    return weights


def test_weights_begin_as_the_file_says() -> None:
    weights = morphed()
    assert weights.values.dtype == np.float32
    assert weights.values.tolist() == [0.5, -1, 0, 0, 0, 0.25, 2]
    slices = [weights.slice_of(node) for node in range(5)]
    assert [weights.values[each].size for each in slices] == [2, 0, 3, 0, 2]
    assert weights.values[slices[4]].tolist() == [0.25, 2]


def test_a_change_bumps_the_version_and_the_same_again_does_not() -> None:
    weights = morphed()
    weights.set(2, (0, 1, 0))
    assert weights.version == 1
    assert weights.values.tolist() == [0.5, -1, 0, 1, 0, 0.25, 2]
    weights.set(2, (0, 1, 0))
    assert weights.version == 1
    weights.write(np.array([0, 6]), [0.75, 3])
    assert weights.version == 2
    assert weights.values.tolist() == [0.75, -1, 0, 1, 0, 0.25, 3]


@pytest.mark.parametrize("given", [(1, 2), "abc", (1, 2, np.nan), (0, 0, 1e30)])
def test_what_is_no_weight_is_refused_and_changes_nothing(
    given: object,
) -> None:
    weights = morphed()
    with pytest.raises(OptionError, match="morph weights: "):
        weights.set(2, given)
    assert weights.version == 0
    assert weights.values.tolist() == [0.5, -1, 0, 0, 0, 0.25, 2]


def test_a_model_without_targets_has_none() -> None:
    assert Scene().add(make_model([1], [0], [-1])).morph_weights is None


def test_two_copies_have_weights_of_their_own() -> None:
    model = make_model([1], [0], [-1])
    model.meshes = [Mesh("", model.meshes[0].primitives, [], 1)]
    scene = Scene()
    first, second = scene.add(model), scene.add(model)
    assert first.morph_weights is not None
    assert second.morph_weights is not None
    first.morph_weights.set(0, [1])
    assert second.morph_weights.values.tolist() == [0]
