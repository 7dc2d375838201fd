"""Reference lighting against Mitsuba 3, a path tracer of other people."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import Material
from moka.model.geometry import sphere
from tests.support import mitsuba_spheres
from tests.support.mitsuba_spheres import BALLS, SIZE, environment_map
from tests.support.pictures import draw_radiance, scene_of, square_camera

pytestmark = pytest.mark.gpu

EDGE = 0.9  # of the radius: beyond, a pixel also sees what is behind

Pictures = dict[str, NDArray[np.float32]]


@pytest.fixture(scope="module")
def traced(tmp_path_factory: pytest.TempPathFactory) -> Pictures:
    """Mitsuba's pictures by the names of BALLS."""
    if importlib.util.find_spec("mitsuba") is None:
        pytest.skip("mitsuba is not installed")
    path = tmp_path_factory.mktemp("mitsuba") / "spheres.npz"
    done = subprocess.run(
        [sys.executable, "-m", mitsuba_spheres.__name__, str(path)],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    with np.load(path) as pictures:
        return dict(pictures)


@pytest.mark.parametrize("name", BALLS)
def test_a_sphere_has_the_radiance_that_mitsuba_sees(
    name: str, traced: Pictures, egl_device: GraphicsDevice
) -> None:
    """The mirror tells orientations, the others units and the BRDF."""
    ball = BALLS[name]
    material = Material(
        base_colour_factor=(*ball.colour, 1.0),
        metallic_factor=ball.metalness,
        roughness_factor=ball.roughness,
    )
    scene = scene_of(
        [(sphere(1.0, 256, 128), material, np.eye(4))],
        Environment(environment_map()),
    )
    drawn = draw_radiance(
        egl_device,
        scene,
        square_camera(),
        (SIZE, SIZE),
        ibl="reference",
        reference_samples=1024,
        multiscatter=False,
    )
    centre = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    inside = np.hypot(*np.meshgrid(centre, centre)) < EDGE
    ratio = drawn[inside][:, :3] / traced[name][inside] - 1
    # Noise of two estimates. A pixel is a square of normals, and the 128
    # frames of one see it at other points than the other.
    assert np.sqrt(np.mean(ratio**2)) < 0.02
    assert np.abs(ratio.mean(axis=0)).max() < 0.004
