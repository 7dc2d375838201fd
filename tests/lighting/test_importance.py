"""Importance sampling of environment maps: exact probabilities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from moka.lighting import importance
from moka.lighting.equirectangular import solid_angles
from moka.lighting.importance import (
    alias_table,
    cell_weights,
    importance_table,
)
from tests.support.oracles.reference import bilinear

WEIGHTS = st.lists(
    st.one_of(st.just(0.0), st.floats(1e-6, 1e9)), min_size=1, max_size=40
).filter(any)


def probabilities(stay: np.ndarray, alias: np.ndarray) -> np.ndarray:
    """What drawing from an alias table gives each item, exactly."""
    result = stay.copy()
    np.add.at(result, alias, 1.0 - stay)
    return result / len(stay)


@given(WEIGHTS)
def test_an_alias_table_has_the_probabilities_of_its_weights(weights):
    weights = np.array(weights)
    stay, alias = alias_table(weights)
    assert ((stay >= 0.0) & (stay <= 1.0)).all()
    assert probabilities(stay, alias) == pytest.approx(
        weights / weights.sum(), abs=1e-14 * len(weights)
    )


def sunny_map(height: int = 16) -> np.ndarray:
    """Dim noise, a sun of one texel on the seam, and a black row."""
    generator = np.random.default_rng(1)
    pixels = generator.uniform(0.0, 2.0, (height, 2 * height, 3))
    pixels[height // 2 + 1] = 0.0
    pixels[height // 4, 0] = (9e4, 8e4, 5e4)
    return pixels.astype(np.float32)


def test_the_table_says_the_weights_and_integrates_to_one():
    pixels = sunny_map()
    table = importance_table(pixels).astype(np.float64)
    assert table.shape == (16, 32, 4)
    alias = (table[..., 2] * 32 + table[..., 1]).astype(int).ravel()
    chance = probabilities(table[..., 0].ravel(), alias)
    density = table[..., 3] * solid_angles(16, 32)
    assert density.sum() == pytest.approx(1.0, abs=1e-6)
    # Float32 thresholds of N items shift a probability by 6e-8 / N each.
    assert np.abs(chance - density.ravel()).max() < 1e-7


def test_weights_are_the_flux_of_the_interpolated_map():
    pixels = sunny_map(8)
    fine = 16
    rows, columns = 8 * fine, 16 * fine
    v, u = np.meshgrid(
        (np.arange(rows) + 0.5) / rows,
        (np.arange(columns) + 0.5) / columns,
        indexing="ij",
    )
    luminance = bilinear(pixels, np.stack((u, v), axis=-1)) @ (
        0.2126,
        0.7152,
        0.0722,
    )
    mean = luminance.reshape(8, fine, 16, fine).mean(axis=(1, 3))
    assert cell_weights(pixels) == pytest.approx(
        mean * solid_angles(8, 16), rel=2e-3
    )


def test_large_maps_share_cells(monkeypatch):
    monkeypatch.setattr(importance, "LARGEST_HEIGHT", 8)
    pixels = sunny_map(32)
    shared = importance_table(pixels)
    assert shared.shape == (8, 16, 4)
    monkeypatch.setattr(importance, "LARGEST_HEIGHT", 1024)
    whole = cell_weights(pixels)
    weights = whole.reshape(8, 4, 16, 4).sum(axis=(1, 3)) / whole.sum()
    assert shared[..., 3] == pytest.approx(
        weights / solid_angles(8, 16), rel=1e-6
    )


@pytest.mark.parametrize("shape", [(1, 1, 3), (2, 4, 3)])
def test_black_and_tiny_maps_are_sampled_uniformly(shape):
    table = importance_table(np.zeros(shape, np.float32))
    assert table[..., 3] == pytest.approx(1.0 / (4.0 * np.pi))


@pytest.mark.gpu
def test_directions_have_the_density_they_claim():
    """Chi-square over the cells; density of sample and of lookup agree."""
    from tests.support.gpu import gpu

    pixels = np.sqrt(sunny_map())  # a sun that leaves others their share
    table = importance_table(pixels)
    points = np.random.default_rng(2).random((200_000, 3))
    texture = gpu().texture(table)
    drawn, claimed, found = (
        gpu().evaluate(
            expression,
            "importance",
            textures={"importance_table": texture},
            point=points,
        )
        for expression in (
            "sample_environment(point.xy, point.z).xyz",
            "sample_environment(point.xy, point.z).w",
            "environment_density(sample_environment(point.xy, point.z).xyz)",
        )
    )
    assert np.abs(np.linalg.norm(drawn, axis=1) - 1.0).max() < 1e-6
    # Rounding puts a few directions on the other side of a border.
    assert np.mean(claimed != found) < 1e-3
    u = 0.5 + np.arctan2(drawn[:, 2], drawn[:, 0]) / (2 * np.pi)
    v = np.arccos(np.clip(drawn[:, 1], -1, 1)) / np.pi
    counts = np.histogram2d(v, u, bins=(16, 32), range=((0, 1), (0, 1)))[0]
    expected = len(points) * table[..., 3].astype(float) * solid_angles(16, 32)
    enough = expected > 20
    observed = np.append(counts[enough], counts[~enough].sum())
    wanted = np.append(expected[enough], expected[~enough].sum())
    wanted *= observed.sum() / wanted.sum()
    assert stats.chisquare(observed, wanted).pvalue > 0.001
