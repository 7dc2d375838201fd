"""Every sampler against the density that it is said to have: chi-square.

Pearson's test (as Mitsuba 3 has it for its own): counts of random samples
over cells of the sphere against the integral of the density over them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy import stats

from tests.support.gpu import gpu
from tests.support.oracles.directions import half_vectors, spherical
from tests.support.oracles.environment import around
from tests.support.oracles.specular import ggx, smith_lambda

pytestmark = pytest.mark.gpu

COUNT = 200_000
CELLS, FINE = 16, 24
# One sampler in a thousand may fail by chance; points are always the same.
SIGNIFICANCE = 0.001


@dataclass(frozen=True)
class Sampler:
    """GLSL of a point x and, where it has one, a view v of a cosine."""

    expression: str
    include: str
    density: Callable[..., np.ndarray]
    cosine: float = 1.0


def cosine(d: np.ndarray, _v: np.ndarray) -> np.ndarray:
    return d[..., 2] / np.pi


def normals(alpha: float) -> Callable[..., np.ndarray]:
    return lambda h, _v: ggx(h[..., 2], alpha) * h[..., 2]


def visible(alpha: float) -> Callable[..., np.ndarray]:
    def density(h: np.ndarray, v: np.ndarray) -> np.ndarray:
        shadowing = 1.0 / (1.0 + smith_lambda(v[2], alpha))
        lobe = ggx(h[..., 2], alpha) / v[2]
        return shadowing * np.maximum(h @ v, 0.0) * lobe

    return density


def reflections(alpha: float) -> Callable[..., np.ndarray]:
    """Eto and Tokuyoshi 2023, equation 8, of directions above the surface."""

    def density(l: np.ndarray, v: np.ndarray) -> np.ndarray:  # noqa: E741
        h = half_vectors(np.broadcast_to(v, l.shape), l)
        sine = np.hypot(v[0], v[1])
        s = (1.0 + sine) ** 2
        k = (1.0 - alpha**2) * s / (s + alpha**2 * v[2] ** 2)
        stretched = np.sqrt(alpha**2 * sine**2 + v[2] ** 2)
        return ggx(h[..., 2], alpha) / (2.0 * (k * v[2] + stretched))

    return density


SAMPLERS = {
    "cosine": Sampler("sample_cosine_hemisphere(x)", "sampling", cosine),
    **{
        f"normals {alpha}": Sampler(
            f"sample_ggx(x, {alpha})", "sampling", normals(alpha)
        )
        for alpha in (0.15, 0.5, 1.0)
    },
    **{
        f"visible normals {alpha} at {n_dot_v}": Sampler(
            f"sample_ggx_visible(x, v, {alpha})",
            "sampling",
            visible(alpha),
            n_dot_v,
        )
        for alpha in (0.15, 0.5, 1.0)
        for n_dot_v in (0.1, 0.6, 1.0)
    },
    **{
        f"reflections {alpha} at {n_dot_v}": Sampler(
            f"sample_visible_reflection(x, v, {alpha})",
            "visible_reflection",
            reflections(alpha),
            n_dot_v,
        )
        for alpha in (0.15, 0.5, 1.0)
        for n_dot_v in (0.1, 0.6, 1.0)
    },
}


def points(count: int = COUNT) -> np.ndarray:
    return np.random.default_rng(11).random((count, 2))


def assert_distributed(counts: np.ndarray, expected: np.ndarray) -> None:
    """Cells with few samples are one; what is in no cell is another."""
    enough = expected > 10.0
    observed = np.append(counts[enough], counts[~enough].sum())
    wanted = np.append(expected[enough], expected[~enough].sum())
    rest = COUNT - wanted.sum()
    if rest > 1.0:
        observed = np.append(observed, COUNT - observed.sum())
        wanted = np.append(wanted, rest)
    kept = wanted > 1e-3
    assert observed[~kept].sum() == 0
    wanted = wanted[kept] * observed[kept].sum() / wanted[kept].sum()
    assert stats.chisquare(observed[kept], wanted).pvalue > SIGNIFICANCE


@pytest.mark.parametrize("name", SAMPLERS)
def test_directions_over_the_hemisphere(name: str) -> None:
    sampler = SAMPLERS[name]
    view = spherical(sampler.cosine, 0.4)
    drawn = (
        gpu()
        .evaluate(
            sampler.expression,
            sampler.include,
            {"MOKA_BRDF_GLTF": 1},
            x=points(),
            v=np.tile(view, (COUNT, 1)),
        )
        .astype(float)
    )
    # Unequal in height: lobes are narrow around the pole.
    edges = 1.0 - np.linspace(0.0, 1.0, CELLS + 1) ** 2
    turn = np.arctan2(drawn[:, 1], drawn[:, 0])
    counts, _, _ = np.histogram2d(
        drawn[:, 2],
        turn,
        bins=(edges[::-1], np.linspace(-np.pi, np.pi, CELLS + 1)),
    )
    x = (np.arange(CELLS * FINE) + 0.5) / (CELLS * FINE)
    height = 1.0 - x**2
    weight = 2.0 * x / (CELLS * FINE)
    azimuth = (2.0 * x - 1.0) * np.pi
    values = sampler.density(spherical(height[:, None], azimuth), view)
    values = values * weight[:, None] * 2.0 * np.pi / (CELLS * FINE)
    cells = values.reshape(CELLS, FINE, CELLS, FINE).sum(axis=(1, 3))
    assert_distributed(counts, COUNT * cells[::-1])


@pytest.mark.parametrize("radius", [0.0005, 0.00465, 0.2])
def test_directions_over_a_disc(radius: float) -> None:
    """By distance and azimuth both are even."""
    centre = spherical(0.3, 2.0)
    drawn, density = (
        gpu()
        .evaluate(
            expression,
            "sun_disc",
            {"MOKA_BRDF_GLTF": 1},
            x=points(),
            c=np.tile(centre, (COUNT, 1)),
        )
        .astype(float)
        for expression in (
            f"sample_disc(x, c, {radius}) - c",
            f"disc_density({radius})",
        )
    )
    tangent, bitangent, _ = around(centre)
    chord = np.sum(drawn**2, axis=-1)
    # The square of a chord is 2 (1 - cos), and even; in float32 the chord
    # of a direction is good to 1e-7.
    share = chord / (4.0 * np.sin(radius / 2.0) ** 2)
    rounding = 4e-7 / radius
    assert share.max() < 1.0 + 2.0 * rounding
    counts, _, _ = np.histogram2d(
        np.minimum(share, 1.0),
        np.arctan2(drawn @ bitangent, drawn @ tangent),
        bins=CELLS,
        range=((0.0, 1.0), (-np.pi, np.pi)),
    )
    assert_distributed(counts, np.full((CELLS, CELLS), COUNT / CELLS**2))
    area = 4.0 * np.pi * np.sin(radius / 2.0) ** 2
    assert density == pytest.approx(1.0 / area, rel=1e-6)


def test_places_in_a_tent() -> None:
    """1 - |x| over -1 to 1, in both axes."""
    drawn = gpu().evaluate("sample_tent(x)", "importance", x=points())
    counts, edges, _ = np.histogram2d(
        *drawn.T.astype(float), bins=CELLS, range=((-1, 1), (-1, 1))
    )
    sums = np.where(edges < 0.0, 0.5 * (1 + edges) ** 2, 0.0)
    sums = np.where(edges >= 0.0, 1.0 - 0.5 * (1 - edges) ** 2, sums)
    shares = np.diff(sums)
    assert_distributed(counts, COUNT * np.outer(shares, shares))
