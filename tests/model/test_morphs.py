"""Morph targets as files have them: counts and weights that agree."""

from typing import Any

import pytest

from moka.core.errors import ModelError
from moka.model.load import load_model
from tests.model.files import changed, glb, triangle

TARGETS = [{"POSITION": 0}, {"POSITION": 0}]
MORPHED = changed("meshes[0].primitives[0].targets", TARGETS, triangle())


def test_targets_and_weights_are_counted() -> None:
    document = changed("meshes[0].weights", [0.25, 0.5], MORPHED)
    document = changed("nodes[0].weights", [1, 0], document)
    model = load_model(glb(document))
    assert model.meshes[0].target_count == 2
    assert model.meshes[0].weights == [0.25, 0.5]
    assert model.nodes.weights == {0: [1, 0]}


@pytest.mark.parametrize(
    ("path", "value", "where", "what"),
    [
        ("meshes[0].weights", [1], "meshes[0].weights", "are 1 for 2 morph"),
        ("nodes[0].weights", [1, 2, 3], "nodes[0].weights", "are 3 for 2"),
        ("nodes[0].weights", [0, 1e30], "nodes[0].weights", "are beyond"),
        (
            "meshes[0].primitives[1]",
            {"attributes": {"POSITION": 0}, "targets": TARGETS[:1]},
            "meshes[0].primitives[1].targets",
            "are 1, those of the first primitive are 2",
        ),
        ("nodes[1]", {"weights": [1]}, "nodes[1].weights", "has none"),
    ],
)
def test_counts_that_disagree_are_errors(
    path: str, value: Any, where: str, what: str
) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(glb(changed(path, value, MORPHED)))
    assert f"{where}: " in str(caught.value)
    assert what in str(caught.value)
    assert "\n" not in str(caught.value)
