"""The BRDF table against quadrature in float64."""

from functools import cache

import numpy as np
import pytest

from tests.support.gpu import gpu
from tests.support.oracles import specular as oracle

pytestmark = pytest.mark.gpu

SIZE = 128
SAMPLES = 512
TOLERANCE = 0.005
BRDFS = ("GLTF", "KARIS", "BLINN_PHONG")


@cache
def table(brdf: str) -> np.ndarray:
    """Rows of roughness, columns of n.v, then scale and bias."""
    defines = {f"MOKA_BRDF_{brdf}": 1, "MOKA_SAMPLE_COUNT": SAMPLES}
    texels = gpu().draw("brdf_table.frag", (SIZE, SIZE), defines=defines)
    return texels[..., :2].astype(float)


def expected(brdf: str, n_dot_v, roughness) -> np.ndarray:
    nodes = 24  # good to 5e-4
    if brdf == "BLINN_PHONG":
        return oracle.table_of_blinn_phong(n_dot_v, roughness, nodes)
    visibility = {
        "GLTF": oracle.smith_correlated,
        "KARIS": oracle.schlick_ggx_environment,
    }[brdf]
    return oracle.table_of_microfacets(n_dot_v, roughness, visibility, nodes)


def bilinear(texels: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    column, row = x * SIZE - 0.5, y * SIZE - 0.5
    i, j = np.floor(column).astype(int), np.floor(row).astype(int)
    s, t = (column - i)[:, None], (row - j)[:, None]
    low = texels[j, i] * (1.0 - s) + texels[j, i + 1] * s
    high = texels[j + 1, i] * (1.0 - s) + texels[j + 1, i + 1] * s
    return low * (1.0 - t) + high * t


def test_the_oracle_knows_what_a_white_furnace_returns():
    """Published values for n.v = 1; 1 - ln 2 is exact."""
    roughness = np.array([0.25, 0.5, 0.75, 1.0])
    albedo = expected("GLTF", 1.0 - 1e-9, roughness).sum(axis=-1)
    assert np.abs(albedo - [0.996, 0.916, 0.627, 0.307]).max() < 5e-4
    assert albedo[-1] == pytest.approx(1.0 - np.log(2.0), abs=1e-5)


@pytest.mark.parametrize("brdf", BRDFS)
def test_every_second_texel(brdf):
    """x is n.v, y is roughness, both at texel centres."""
    centres = ((np.arange(SIZE) + 0.5) / SIZE)[::2]
    n_dot_v, roughness = np.meshgrid(centres, centres)
    error = np.abs(table(brdf)[::2, ::2] - expected(brdf, n_dot_v, roughness))
    assert error.max() <= TOLERANCE


@pytest.mark.parametrize("brdf", BRDFS)
def test_between_texels(brdf):
    """Bilinear, as the surface reads it.

    Near n.v = 0 and roughness 0 the albedo is a function of n.v / alpha,
    which no uniform grid resolves: up to 0.03 between the first columns,
    where n.v < 0.02, that is within 1.2 degrees of the silhouette.
    """
    generator = np.random.default_rng(5)
    n_dot_v = generator.uniform(2.5 / SIZE, 1.0 - 0.51 / SIZE, 3000)
    roughness = generator.uniform(0.51 / SIZE, 1.0 - 0.51 / SIZE, 3000)
    value = bilinear(table(brdf), n_dot_v, roughness)
    error = np.abs(value - expected(brdf, n_dot_v, roughness))
    assert error.max() <= TOLERANCE


@pytest.mark.parametrize("brdf", BRDFS)
def test_nothing_reflects_more_than_it_gets(brdf):
    assert table(brdf).min() >= 0.0
    assert table(brdf).sum(axis=-1).max() <= 1.0 + 1e-6
