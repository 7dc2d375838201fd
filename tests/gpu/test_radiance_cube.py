"""The cubes that an environment's map becomes: what each face is made of."""

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.preintegration import Preintegrator
from moka.lighting.suns import SplitEnvironment
from tests.support.cube_passes import resample

pytestmark = pytest.mark.gpu

HEIGHT = 64


@pytest.fixture
def base() -> np.ndarray:
    generator = np.random.default_rng(5)
    return generator.uniform(0.5, 1.0, (HEIGHT, 2 * HEIGHT, 3)).astype("f4")


def cubes_of(split: SplitEnvironment) -> tuple[np.ndarray, np.ndarray]:
    """Level 0 of the mirror image and of what it is made from."""
    with GraphicsDevice.open() as device:
        maps = Preintegrator(device, FullscreenPasses(device)).prepare(
            split,
            background=False,
            specular=True,
            irradiance=False,
            radiance=True,
        )
        maps.fill()
        mirror, source = (
            np.stack(
                [device.read_texture(cube, face=face) for face in range(6)]
            )
            for cube in (maps.specular, maps.radiance)
        )
    return mirror[..., :3], source[..., :3]


def test_the_face_with_the_sun_is_made_again(base: np.ndarray) -> None:
    full = base.copy()
    # In the middle of +Z: three quarters along, halfway down.
    full[HEIGHT // 2, 3 * HEIGHT // 2] = 1e4
    mirror, source = cubes_of(SplitEnvironment(full, base, ()))
    size = len(source[0])
    assert np.array_equal(source, resample(base, size))
    for face in (0, 1, 2, 3, 5):
        assert np.array_equal(mirror[face], source[face])
    assert np.array_equal(mirror[4], resample(full, size, 2, face=4))
    assert mirror[4].max() > 1e3


def test_without_suns_all_faces_are_fine(base: np.ndarray) -> None:
    _, source = cubes_of(SplitEnvironment(base, base, ()))
    assert np.array_equal(source, resample(base, len(source[0]), 2))
