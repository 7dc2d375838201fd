"""What levels of normals average, against lobes integrated in float64."""

import numpy as np
import pytest

from moka.core.mip_levels import reduce_levels
from moka.core.normal_levels import normal_filter, slope_variance
from tests.core.test_mip_levels import shrink


def normals(height: int, width: int, slope: float) -> np.ndarray:
    """Unit normals whose slopes are Gaussian."""
    random = np.random.default_rng(height + width)
    slopes = random.normal(0, slope, (height, width, 2))
    vectors = np.dstack([-slopes, np.ones((height, width))])
    return vectors / np.linalg.norm(vectors, axis=2, keepdims=True)


def encode(vectors: np.ndarray, dtype: type = np.uint8) -> np.ndarray:
    white = np.iinfo(dtype).max
    codes = np.rint((vectors + 1) / 2 * white)
    alpha = np.full((*vectors.shape[:2], 1), white)
    return np.concatenate([codes, alpha], axis=2).astype(dtype)


def distribution(alpha_squared: float, cosine: np.ndarray) -> np.ndarray:
    """GGX of half vectors: Walter et al. 2007, equation 33."""
    return alpha_squared / (np.pi * (cosine**2 * (alpha_squared - 1) + 1) ** 2)


@pytest.mark.parametrize("slope", [0.03, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("roughness", [0.1, 0.2, 0.3, 0.5])
def test_a_wider_lobe_stands_for_many(slope: float, roughness: float) -> None:
    """By how far light lies from where it belongs, in radians.

    At most 0.75 of what it is without.
    """
    many = normals(60, 60, slope).reshape(-1, 3)
    added = slope_variance(np.sum(many.mean(axis=0) ** 2))
    angle = (np.arange(500) + 0.5) / 500 * np.pi / 2
    ring = np.sin(angle) * np.cos(angle)
    half = np.column_stack([np.sin(angle), 0 * angle, np.cos(angle)])
    squared = roughness**4

    def reached(lobe: np.ndarray) -> np.ndarray:
        """The part of the light up to each angle."""
        return np.cumsum(lobe * ring) / np.sum(lobe * ring)

    exact = reached(
        distribution(squared, np.clip(half @ many.T, 0, 1)).mean(axis=1)
    )
    distances = [
        np.abs(reached(distribution(width, np.cos(angle))) - exact).mean()
        for width in (squared, squared + added)
    ]
    assert distances[1] < 0.75 * distances[0]


def test_variance_ends_at_one_and_begins_at_nothing() -> None:
    lengths = np.linspace(0, 1, 400) ** 2
    variance = slope_variance(lengths)
    assert np.isfinite(variance).all()
    assert (np.diff(variance) <= 0).all()
    assert variance[0] == 1
    assert variance[-1] == 0
    assert slope_variance(1.01) == 0


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("size", [(64, 64), (31, 20), (1, 8), (256, 4)])
def test_alpha_is_what_the_texel_averages(
    size: tuple[int, int], dtype: type
) -> None:
    texels = encode(normals(*size, 0.3), dtype)
    white = np.iinfo(dtype).max
    finish = normal_filter(texels, scale=0.8, roughness_factor=None)
    levels = reduce_levels(texels, finish=finish)
    assert levels[0] is texels
    vectors = texels[:, :, :3] / white * 2.0 - 1
    moments = np.dstack([vectors, np.sum(vectors**2, axis=2)])
    for level in levels[1:]:
        moments = shrink(shrink(moments, 0), 1)
        length = np.sum(moments[:, :, :3] ** 2, axis=2) / moments[:, :, 3]
        exact = 1 - 0.8 * np.sqrt(slope_variance(length))
        assert np.abs(level[:, :, 3] / white - exact).max() < 3 / 255
        mean = level[:, :, :3] / white * 2.0 - 1
        assert np.abs(mean - moments[:, :, :3]).max() < 1.5 / 255


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.3, -0.2), (-1.0, 0.7)])
def test_one_normal_adds_nothing(slope: tuple[float, float]) -> None:
    """Not even where rounding makes it shorter than 1."""
    vector = np.array([*slope, 1.0])
    vectors = np.tile(vector / np.linalg.norm(vector), (16, 16, 1))
    texels = encode(vectors)
    finish = normal_filter(texels, scale=1.0, roughness_factor=None)
    for level in reduce_levels(texels, finish=finish):
        # The square root of rounding in between, to the fourth power below
        # 2e-4 of alpha^2.
        assert (level[:, :, 3] >= 252).all()


def test_roughness_in_the_alpha_grows() -> None:
    texels = encode(normals(32, 32, 0.2))
    texels[:, :, 3] = 51
    factor = 0.9
    finish = normal_filter(texels, scale=1.0, roughness_factor=factor)
    plain = normal_filter(texels, scale=1.0, roughness_factor=None)
    rough = reduce_levels(texels, finish=finish, finest=2)
    spread = reduce_levels(texels, finish=plain, finest=2)
    for level, other in zip(rough, spread, strict=True):
        added = (1 - other[:, :, 3] / 255) ** 2
        exact = ((0.2 * factor) ** 4 + added) ** 0.25 / factor
        assert np.abs(level[:, :, 3] / 255 - exact).max() < 4 / 255
