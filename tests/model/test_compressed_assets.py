"""Real models keep their geometry when it is compressed."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from moka.model import Primitive, load_model, triangle_corners
from tests.support.compressed import DRACO_BITS, with_draco, with_meshopt

pytestmark = pytest.mark.assets

NAMES = ("Duck.glb", "BoxInterleaved.glb", "Avocado/Avocado.gltf")


def primitives(source: Path | bytes) -> list[Primitive]:
    return [
        primitive
        for mesh in load_model(source).meshes
        for primitive in mesh.primitives
    ]


@pytest.mark.parametrize("fallback", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_draco_moves_positions_by_half_a_step(
    assets: Path, name: str, fallback: bool
) -> None:
    path = assets / "models" / name
    packed = with_draco(path, fallback=fallback)
    for before, after in zip(primitives(path), primitives(packed), strict=True):
        np.testing.assert_array_equal(
            triangle_corners(after), triangle_corners(before)
        )
        assert after.attributes.keys() == before.attributes.keys()
        least, greatest = before.bounds
        step = (greatest - least).max() / (2**DRACO_BITS - 1)
        rounding = 2e-7 * np.abs(before.bounds).max()
        for attribute, array in before.attributes.items():
            moved = np.abs(after.attributes[attribute] - array).max()
            is_position = attribute == "POSITION"
            allowed = step / 2 + rounding if is_position else 1e-6
            assert moved <= allowed, attribute


def whole_triangles(primitive: Primitive) -> np.ndarray[Any, Any]:
    """Corners (T, 3) of each triangle, which begin with the least one."""
    corners = triangle_corners(primitive)
    first = corners.argmin(axis=1)[:, None]
    return np.take_along_axis(corners, (first + np.arange(3)) % 3, axis=1)


@pytest.mark.parametrize("name", NAMES)
def test_meshopt_keeps_every_bit(assets: Path, name: str) -> None:
    path = assets / "models" / name
    for before, after in zip(
        primitives(path), primitives(with_meshopt(path)), strict=True
    ):
        assert after.attributes.keys() == before.attributes.keys()
        for attribute, array in before.attributes.items():
            np.testing.assert_array_equal(after.attributes[attribute], array)
        np.testing.assert_array_equal(
            whole_triangles(after), whole_triangles(before)
        )
