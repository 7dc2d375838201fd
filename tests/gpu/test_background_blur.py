"""The environment behind the scene, blurred."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

import moka
from moka.model import cube, model_of
from moka.scene.camera_choice import Look

pytestmark = pytest.mark.gpu

SIDE = 32


def sphere_of(environment: str, ibl: str, blur: float) -> NDArray[np.float32]:
    """What is seen in all directions: (6, SIDE, SIDE, 3)."""
    point = model_of([(cube(1e-6), None, np.eye(4))])  # Too small to see.
    faces = []
    for target in (*np.eye(3), *-np.eye(3)):
        x, y, z = target.tolist()
        look = Look(
            (10 * x, 10 * y, 10 * z), (20 * x, 20 * y, 20 * z), math.pi / 2
        )
        picture = moka.render(
            point,
            environment=environment,
            size=(SIDE, SIDE),
            camera=look.camera(),
            background_blur=blur,
            ibl=ibl,
            reference_samples=1 if ibl == "reference" else None,
            samples=1,
        )
        faces.append(picture.pixels[..., :3])
    return np.stack(faces)


def solid_angles() -> NDArray[np.float64]:
    """Of the pixels of all six faces; their sum is 1."""
    step = (np.arange(SIDE) + 0.5) / (SIDE / 2) - 1
    across, up = np.meshgrid(step, step)
    face = (1 + across**2 + up**2) ** -1.5
    return np.broadcast_to(face / (6 * face.sum()), (6, SIDE, SIDE))


@pytest.mark.parametrize("ibl", ["split-sum", "reference"])
def test_a_blurred_background_keeps_its_light(ibl: str) -> None:
    """Its mean over all directions, suns included; its edges are gone."""
    weights = solid_angles()[..., None]
    sharp, blurred = (sphere_of("sky", ibl, blur) for blur in (0.0, 0.5))
    means = [(weights * each).sum((0, 1, 2)) for each in (sharp, blurred)]
    # A sun is smaller than a pixel of the sharp picture.
    np.testing.assert_allclose(means[1], means[0], rtol=0.1)
    steps = [np.abs(np.diff(each, axis=2)).max() for each in (sharp, blurred)]
    assert steps[1] < 0.5 * steps[0]


def test_a_little_blur_counts_no_sun_twice() -> None:
    """Where the cube has the sun as well as its light."""
    weights = solid_angles()[..., None]
    means = [
        (weights * sphere_of("sky", "split-sum", blur)).sum((0, 1, 2))
        for blur in (0.02, 0.05, 0.5)
    ]
    np.testing.assert_allclose(means[:2], [means[2]] * 2, rtol=0.1)


def test_uniform_light_has_nothing_to_blur() -> None:
    blurred = sphere_of("furnace", "split-sum", 0.7)
    np.testing.assert_allclose(blurred, 1.0, rtol=2e-3)


def test_a_blur_that_is_none_is_refused() -> None:
    with pytest.raises(moka.OptionError, match="background_blur"):
        moka.render(size=(8, 8), background_blur=1.5)
