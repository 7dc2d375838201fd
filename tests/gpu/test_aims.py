"""What moka promises of its errors, under a map that nothing was tuned to.

Spheres of metal and of a dielectric, roughness 0.1 to 1, single scattering,
against exact integration in float64: the mean relative RMSE of a sphere and
the mean of its median relative errors.
"""

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from tests.support.oracles import reference
from tests.support.oracles.reflection import MapOracle, errors, sphere_points
from tests.support.outdoors import outdoors
from tests.support.patches import draw_patches
from tests.support.probe import LightingProbe

pytestmark = pytest.mark.gpu

COPPER = (0.95, 0.64, 0.54)
LEAF = (0.2, 0.5, 0.3)
ROUGHNESSES = (0.1, 0.2, 0.4, 0.7, 1.0)
NORMALS, VIEWS = sphere_points(24)


@cache
def truth() -> NDArray[np.float64]:
    """(metal and dielectric, roughnesses, points, 3)."""
    oracle = MapOracle(outdoors(), tent=3)
    leaf = oracle.diffuse(NORMALS, VIEWS, LEAF, 0.04)
    metal, dielectric = (
        [oracle.specular(NORMALS, VIEWS, r, f0) for r in ROUGHNESSES]
        for f0 in (COPPER, (0.04,) * 3)
    )
    return np.array([metal, [lobe + leaf for lobe in dielectric]])


@pytest.mark.parametrize(
    ("ibl", "rmse", "median"),
    # A quarter more than measured; the aims were 0.08 / 0.035 and, with 16
    # samples, 0.045 / 0.028.
    [("split-sum", 0.0165, 0.0095), ("filtered", 0.008, 0.0067)],
)
def test_preintegrated_lighting(
    egl_device: GraphicsDevice, ibl: str, rmse: float, median: float
) -> None:
    probe = LightingProbe(egl_device, Environment(outdoors()), ibl=ibl)
    found = [
        errors(
            probe.shade(
                NORMALS, VIEWS, roughness, colour=colour, metalness=metalness
            ),
            exact,
        )
        for colour, metalness, spheres in zip(
            (COPPER, LEAF), (1.0, 0.0), truth(), strict=True
        )
        for roughness, exact in zip(ROUGHNESSES, spheres, strict=True)
    ]
    assert np.mean(found, axis=0)[0] < rmse
    assert np.mean(found, axis=0)[1] < median


def test_reference_lighting(egl_device: GraphicsDevice) -> None:
    """With the samples it takes by default; the aim was 0.015 / 0.004."""
    kept = slice(0, len(NORMALS), 4)
    exact = truth()[:, :, kept].reshape(-1, len(NORMALS[kept]), 3)
    drawn = draw_patches(
        egl_device,
        Environment(outdoors()),
        NORMALS[kept],
        [
            reference.Material(colour, metalness, roughness)
            for colour, metalness in ((COPPER, 1.0), (LEAF, 0.0))
            for roughness in ROUGHNESSES
        ],
        ibl="reference",
        multiscatter=False,
    )
    difference = drawn - exact[:, :, np.newaxis]
    rmse = np.sqrt(np.mean(difference**2, axis=(1, 2, 3)))
    relative = np.abs(difference) / exact[:, :, np.newaxis]
    assert np.mean(rmse / exact.mean(axis=(1, 2))) < 0.005
    assert np.median(relative) < 0.003
