"""Models made in memory."""

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.material.material import Material
from moka.model import (
    CameraDescription,
    LightKind,
    Perspective,
    PunctualLight,
    cube,
    model_of,
    quad,
)


def moved(x: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def test_equal_pairs_share_a_mesh() -> None:
    shape, other = cube(), quad()
    red, blue = Material("red"), Material("blue")
    model = model_of(
        [
            (shape, red, moved(0)),
            (shape, blue, moved(1)),
            (shape, red, moved(2)),
            (other, None, moved(3)),
        ]
    )
    nodes, meshes = model.instances()
    assert nodes.tolist() == [0, 1, 2, 3]
    assert meshes.tolist() == [0, 1, 0, 2]
    assert model.materials == [red, blue]
    assert model.meshes[1].primitives[0].material is blue
    assert shape.material is None
    arrays = {
        id(mesh.primitives[0].attributes["POSITION"])
        for mesh in model.meshes[:2]
    }
    assert len(arrays) == 1
    assert model.nodes.world_matrices()[2, 0, 3] == 2
    bounds = model.bounds()
    assert bounds is not None
    assert bounds.tolist() == [[-0.5] * 3, [3.5, 0.5, 0.5]]


def test_primitives_that_the_caller_drops_stay_apart() -> None:
    """Identities of dead objects are given out again."""
    model = model_of((cube(size), None, np.eye(4)) for size in (1, 2, 3))
    assert len(model.meshes) == 3


def test_places_cameras_and_lights() -> None:
    camera = CameraDescription(Perspective(1.0), "eye")
    light = PunctualLight(LightKind.POINT, name="lamp")
    model = model_of(
        [(cube(), None, np.eye(4))],
        name="made",
        cameras=[(camera, moved(5))],
        lights=[(light, moved(6))],
    )
    (node,), (index,) = model.camera_instances()
    assert model.cameras[index] is camera
    assert model.nodes.names[node] == "eye"
    assert model.nodes.local[node, 0, 3] == 5
    (node,), (index,) = model.light_instances()
    assert model.lights[index] is light
    assert model.nodes.names[node] == "lamp"
    assert model.name == "made"


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.eye(3), "4 x 4"),
        ([[1, 2], [3]], "4 x 4"),
        (np.full((4, 4), np.nan), "finite"),
    ],
)
def test_refuses_other_matrices(matrix: object, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        model_of([(cube(), None, matrix)])  # type: ignore[list-item]
