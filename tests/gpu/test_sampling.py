"""Point sets and sampling in GLSL."""

import numpy as np
import pytest

from moka.lighting.samples import hammersley
from tests.support.gpu import gpu
from tests.support.oracles.directions import dot, random_directions, spherical
from tests.support.oracles.specular import ggx, smith_lambda

pytestmark = pytest.mark.gpu


def test_hammersley_equals_its_twin():
    index = np.arange(1000)
    points = gpu().evaluate(
        "hammersley(uint(i + 0.5), 1000u)", "sampling", i=index
    )
    assert np.abs(points - hammersley(1000)).max() < 1e-6


def test_the_largest_indices_stay_inside():
    value = gpu().evaluate(
        "radical_inverse(0xFFFFFFFFu - uint(i))", "sampling", i=np.arange(9)
    )
    assert value.max() < 1.0


def test_tangent_bases_are_right_handed_and_orthonormal():
    n = np.concatenate(
        (
            random_directions(5000, 1, -1.0),
            [[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, 0]],
            spherical(np.full(50, -1.0 + 1e-6), np.linspace(0, 6, 50)),
        )
    )
    t, b, z = (
        gpu().evaluate(f"tangent_basis(n)[{i}]", "sampling", n=n)
        for i in range(3)
    )
    assert np.abs(z - n).max() < 1e-7
    for a, c in ((t, b), (t, n), (b, n)):
        assert np.abs(dot(a, c)).max() < 1e-5
    assert np.abs(np.cross(t, b) - n).max() < 1e-5


def histogram(directions: np.ndarray) -> np.ndarray:
    """Shares over 8 x 8 cells of equal solid angle of the hemisphere."""
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    counts, _, _ = np.histogram2d(
        directions[:, 2],
        azimuth,
        bins=8,
        range=((0.0, 1.0), (-np.pi, np.pi)),
    )
    return counts / len(directions)


def shares(density) -> np.ndarray:
    """What ``density`` per steradian gives each of these cells."""
    fine = 64
    cosine = (np.arange(8 * fine) + 0.5) / (8 * fine)
    azimuth = ((np.arange(8 * fine) + 0.5) / (4 * fine) - 1.0) * np.pi
    values = density(spherical(cosine[:, None], azimuth[None, :]))
    cells = values.reshape(8, fine, 8, fine).mean(axis=(1, 3))
    return cells * 2.0 * np.pi / 64.0


def test_cosine_samples():
    value = gpu().evaluate(
        "sample_cosine_hemisphere(x)", "sampling", x=hammersley(50000)
    )
    expected = shares(lambda d: d[..., 2] / np.pi)
    assert np.abs(histogram(value) - expected).max() < 2e-4


@pytest.mark.parametrize("alpha", [0.3, 0.7, 1.0])
def test_ggx_samples(alpha):
    value = gpu().evaluate(
        f"sample_ggx(x, {alpha})", "sampling", x=hammersley(50000)
    )
    expected = shares(lambda h: ggx(h[..., 2], alpha) * h[..., 2])
    assert np.abs(histogram(value) - expected).max() < 4e-4


@pytest.mark.parametrize("alpha", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("n_dot_v", [0.1, 0.6, 1.0])
def test_visible_ggx_samples(alpha, n_dot_v):
    v = spherical(n_dot_v, 0.0)
    value = gpu().evaluate(
        f"sample_ggx_visible(x, v, {alpha})",
        "sampling",
        x=hammersley(50000),
        v=np.tile(v, (50000, 1)),
    )

    def density(h):
        g1 = 1.0 / (1.0 + smith_lambda(n_dot_v, alpha))
        v_dot_h = np.maximum(h @ v, 0.0)
        return g1 * v_dot_h * ggx(h[..., 2], alpha) / n_dot_v

    assert np.abs(histogram(value) - shares(density)).max() < 1e-3


@pytest.mark.parametrize("alpha", [1e-6, 1e-3])
@pytest.mark.parametrize(
    "sampler", ["sample_ggx(x, a)", "sample_ggx_visible(x, v, a)"]
)
def test_narrow_lobes_keep_their_width(alpha, sampler):
    """The sine, which a cosine of 1 - 1e-12 could not hold."""
    x = hammersley(4000)
    value = gpu().evaluate(
        sampler,
        "sampling",
        x=x,
        a=np.full(4000, alpha),
        v=np.tile([0.0, 0.0, 1.0], (4000, 1)),
    )
    sine = np.hypot(value[:, 0], value[:, 1])
    # Half of the half vectors lie within tan(theta) = alpha.
    assert np.median(sine) == pytest.approx(alpha, rel=0.01)
    assert np.isfinite(value).all()
