"""Errors of spheres, for differences of which they are known."""

import importlib.util

import numpy as np
import pytest

from moka.bench.sphere_errors import sphere_errors
from moka.bench.spheres import MATERIALS, SphereGrid

GRID = SphereGrid(MATERIALS[:2], (0.0, 0.4), 8)


def pictures() -> tuple[np.ndarray, np.ndarray]:
    """Spheres of radiance 2, and a copy to be changed."""
    width, height = GRID.size
    truth = np.full((height, width, 4), 2.0, np.float32)
    return truth, truth.copy()


def test_no_difference_is_no_error() -> None:
    errors = sphere_errors(GRID, *pictures())
    values = {k: v for k, v in errors.as_dict().items() if v is not None}
    assert set(values.values()) == {0.0}


def test_one_sphere_brighter_by_a_tenth() -> None:
    truth, picture = pictures()
    picture[:8, 8:, :3] *= 1.1
    errors = sphere_errors(GRID, truth, picture)
    # One of two rough spheres.
    assert errors.relative_rmse == pytest.approx(0.05, rel=1e-5)
    assert errors.bias == pytest.approx(0.05, rel=1e-5)
    assert errors.maximum == pytest.approx(0.1, rel=1e-5)
    assert errors.median == pytest.approx(0.05, rel=1e-5)
    assert errors.mirror == 0.0


def test_a_dark_pixel_weighs_little_in_the_rmse() -> None:
    truth, picture = pictures()
    picture[4, 12, :3] -= 1.0
    errors = sphere_errors(GRID, truth, picture)
    assert errors.maximum == pytest.approx(0.5)
    assert errors.relative_rmse == pytest.approx(0.5 / np.sqrt(52) / 2)
    assert errors.bias == pytest.approx(-0.5 / 52 / 2)
    assert errors.median == 0.0


def test_mirrors_have_their_own_error() -> None:
    truth, picture = pictures()
    picture[:, :8, :3] *= 0.9
    errors = sphere_errors(GRID, truth, picture)
    assert errors.mirror == pytest.approx(0.1, rel=1e-5)
    assert errors.relative_rmse == errors.maximum == 0.0


@pytest.mark.skipif(
    importlib.util.find_spec("flip_evaluator") is None,
    reason="flip-evaluator is not installed",
)
def test_flip_does_not_depend_on_the_brightness_of_the_light() -> None:
    truth, picture = pictures()
    picture[:8, 8:, :3] *= 1.3
    one = sphere_errors(GRID, truth, picture).flip
    other = sphere_errors(GRID, 50 * truth, 50 * picture).flip
    assert one is not None
    assert one > 0.01
    assert other == pytest.approx(one, rel=1e-3)
