"""Real models look the same when their geometry is compressed."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import moka
from tests.support.compressed import with_draco, with_meshopt

pytestmark = [pytest.mark.gpu, pytest.mark.assets]


@pytest.mark.parametrize("name", ["Duck.glb", "BoxInterleaved.glb"])
@pytest.mark.parametrize(
    ("compress", "error", "changed"),
    [
        # Not one bit of a vertex is different; triangles may begin with
        # another corner, which rounds differently.
        (with_meshopt, 1e-6, 0.0),
        # Vertices move by less than 1 / 16384 of the model: some samples
        # along edges and highlights fall to the other side.
        (with_draco, 0.0003, 0.001),
    ],
)
def test_the_picture_is_that_of_the_original(
    assets: Path,
    name: str,
    compress: Callable[[Path], bytes],
    error: float,
    changed: float,
) -> None:
    path = assets / "models" / name
    wanted = moka.render(path, size=(96, 96), samples=1).pixels
    found = moka.render(compress(path), size=(96, 96), samples=1).pixels
    assert wanted is not None
    assert found is not None
    difference = np.abs(found - wanted).max(axis=2)
    assert difference.mean() <= error
    assert (difference > 0.05).mean() <= changed
    # The model is there at all.
    assert wanted[48, 48].std() > 0
