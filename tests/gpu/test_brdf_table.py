"""The BRDF table against quadrature in float64."""

from functools import cache

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.lighting.brdf_table import read_brdf_table
from moka.lighting.make_brdf_tables import draw_brdf_table
from tests.support.oracles import specular as oracle

pytestmark = pytest.mark.gpu

SIZE = 128
TOLERANCE = 0.005
BRDFS = ("GLTF", "KARIS", "BLINN_PHONG")


@cache
def table(brdf: str) -> np.ndarray:
    """Rows of roughness, columns of n.v, then scale and bias."""
    name = brdf.lower().replace("_", "-")
    return read_brdf_table(name).astype(float)


@pytest.mark.parametrize("brdf", BRDFS)
def test_the_files_are_what_the_shaders_say(
    brdf: str, device: GraphicsDevice
) -> None:
    """If not: python -m moka.lighting.make_brdf_tables."""
    drawn = draw_brdf_table(
        device, brdf.lower().replace("_", "-"), samples=2048
    )
    # Fewer samples than the files are made with; rows of wide lobes tell.
    error = np.abs(drawn - table(brdf))
    assert error.max() < 0.003
    assert error.mean() < 1e-4


def expected(brdf: str, n_dot_v, roughness) -> np.ndarray:
    """A view and a lobe of nothing are replaced, as in the shader."""
    n_dot_v, roughness = np.maximum(n_dot_v, 1e-4), np.maximum(roughness, 1e-4)
    nodes = 24  # good to 5e-4
    if brdf == "BLINN_PHONG":
        # Of a larger exponent the power has no digits left.
        roughness = np.maximum(roughness, 1e-3)
        return oracle.table_of_blinn_phong(n_dot_v, roughness, nodes)
    visibility = {
        "GLTF": oracle.smith_correlated,
        "KARIS": oracle.schlick_ggx_environment,
    }[brdf]
    return oracle.table_of_microfacets(n_dot_v, roughness, visibility, nodes)


def bilinear(texels: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    column, row = x * (SIZE - 1), y * (SIZE - 1)
    i, j = (np.minimum(place.astype(int), SIZE - 2) for place in (column, row))
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
    """x is n.v, y is roughness, from 0 at the first to 1 at the last."""
    entries = np.linspace(0.0, 1.0, SIZE)
    kept = np.append(np.arange(0, SIZE, 2), SIZE - 1)
    n_dot_v, roughness = np.meshgrid(entries[kept], entries[kept])
    texels = table(brdf)[np.ix_(kept, kept)]
    assert np.isfinite(table(brdf)).all()
    error = np.abs(texels - expected(brdf, n_dot_v, roughness))
    assert error.max() <= TOLERANCE


@pytest.mark.parametrize("brdf", ["GLTF", "KARIS"])
def test_a_mirror_reflects_what_fresnel_says(brdf):
    lost = (1.0 - np.linspace(0.0, 1.0, SIZE)) ** 5
    exact = np.stack((1.0 - lost, lost), axis=-1)
    # But for the first column, where no lobe is narrow.
    assert np.abs(table(brdf)[0] - exact)[1:].max() < 2e-4


def test_a_rough_metal_seen_face_on_reflects_all_it_should():
    """Turquin's factor is 1 / (1 - ln 2), which a cut edge would miss."""
    value = bilinear(table("GLTF"), np.ones(1), np.ones(1)).sum()
    assert value == pytest.approx(1.0 - np.log(2.0), rel=5e-4)


@pytest.mark.parametrize("brdf", BRDFS)
def test_between_texels(brdf):
    """Bilinear, as the surface reads it.

    Near n.v = 0 and roughness 0 the albedo is a function of n.v / alpha,
    which no uniform grid resolves: up to 0.03 between the first columns,
    where n.v < 0.02, that is within 1.2 degrees of the silhouette.
    """
    generator = np.random.default_rng(5)
    n_dot_v = generator.uniform(0.02, 1.0, 3000)
    roughness = generator.uniform(0.0, 1.0, 3000)
    # Along the edges, where a table of cells has half a texel less.
    n_dot_v[:500] = 1.0
    roughness[500:1000], roughness[1000:1500] = 0.0, 1.0
    value = bilinear(table(brdf), n_dot_v, roughness)
    error = np.abs(value - expected(brdf, n_dot_v, roughness))
    assert error.max() <= TOLERANCE


@pytest.mark.parametrize("brdf", BRDFS)
def test_nothing_reflects_more_than_it_gets(brdf):
    assert table(brdf).min() >= 0.0
    assert table(brdf).sum(axis=-1).max() <= 1.0 + 1e-6
