"""Point sets, frames and narrow lobes in GLSL."""

import numpy as np
import pytest

from moka.lighting.samples import hammersley
from tests.support.gpu import gpu
from tests.support.oracles.directions import dot, random_directions, spherical

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
