"""Importance sampling of environment maps: exact probabilities."""

import numpy as np
import pytest
from scipy import stats

from moka.lighting import importance
from moka.lighting.importance import (
    GUIDE_BASE,
    cell_weights,
    importance_table,
)
from tests.support.oracles.reference import bilinear


def sunny_map(height: int = 16) -> np.ndarray:
    """Dim noise, a sun of one texel on the seam, and a black row."""
    generator = np.random.default_rng(1)
    pixels = generator.uniform(0.0, 2.0, (height, 2 * height, 3))
    pixels[height // 2 + 1] = 0.0
    pixels[height // 4, 0] = (9e4, 8e4, 5e4)
    return pixels.astype(np.float32)


def drawn(table: np.ndarray) -> np.ndarray:
    """The probability of each cell, exactly, by the table's sums."""
    in_row = np.diff(table[..., 0].astype(float), axis=1, prepend=0.0)
    of_rows = np.diff(table[:, 0, 1].astype(float), prepend=0.0)
    return in_row * of_rows[:, None]


def test_cells_are_drawn_by_their_light():
    pixels = sunny_map()
    table = importance_table(pixels)
    assert table.shape == (16, 32, 4)
    sine = np.sin((np.arange(16) + 0.5) / 16 * np.pi)
    light = pixels @ np.array([0.2126, 0.7152, 0.0722]) * sine[:, None]
    # Float32 sums shift a probability by up to 6e-8 of a row's.
    assert drawn(table) == pytest.approx(light / light.sum(), abs=1e-7)
    assert (table[:, -1, 0] == 1.0).all()
    assert (table[-1, :, 1] == 1.0).all()


def test_densities_are_those_of_the_rounded_sums():
    """Dim cells beside a sun have few bits left in a sum."""
    table = importance_table(sunny_map())
    assert table[..., 2] == pytest.approx(drawn(table) * 16 * 32, rel=1e-6)
    assert table[..., 2].mean() == pytest.approx(1.0, abs=1e-6)


def test_large_maps_share_cells(monkeypatch):
    monkeypatch.setattr(importance, "LARGEST_HEIGHT", 8)
    pixels = sunny_map(32)
    shared = importance_table(pixels)
    assert shared.shape == (8, 16, 4)
    monkeypatch.setattr(importance, "LARGEST_HEIGHT", 1024)
    whole = cell_weights(pixels)
    weights = whole.reshape(8, 4, 16, 4).mean(axis=(1, 3)) / whole.mean()
    assert shared[..., 2] == pytest.approx(weights, rel=1e-4, abs=1e-4)


def test_guides_lead_to_where_sums_exceed_a_number():
    table = importance_table(sunny_map(16))
    rows, cells = table.shape[:2]
    guides = table[..., 3].astype(int)
    above = np.arange(cells)[:, None] / cells
    for row in range(rows):
        first = np.argmax(table[row, :, 0] > above, axis=1)
        assert (guides[row] % GUIDE_BASE == first).all()
    above = np.arange(rows)[:, None] / rows
    first = np.argmax(table[:, 0, 1] > above, axis=1)
    assert (guides[:, 0] // GUIDE_BASE == first).all()


@pytest.mark.parametrize("shape", [(1, 1, 3), (2, 4, 3)])
def test_black_and_tiny_maps_are_sampled_uniformly(shape):
    table = importance_table(np.zeros(shape, np.float32))
    sine = np.sin((np.arange(shape[0]) + 0.5) / shape[0] * np.pi)
    expected = np.broadcast_to((sine / sine.mean())[:, None], shape[:2])
    assert table[..., 2] == pytest.approx(expected, rel=1e-6)


@pytest.mark.gpu
@pytest.mark.parametrize("height", [16, 2])
def test_directions_have_the_density_they_claim(height):
    """Chi-square over the cells; density of sample and of lookup agree."""
    from tests.support.gpu import gpu

    # A sun that leaves others their share.
    pixels = np.sqrt(sunny_map(16))[:height, : 2 * height]
    table = importance_table(pixels)
    points = np.random.default_rng(2).random((200_000, 2))
    texture = gpu().texture(table)
    drawn, claimed, found = (
        gpu().evaluate(
            expression,
            "importance",
            textures={"importance_table": texture},
            point=points,
        )
        for expression in (
            "sample_environment(point).xyz",
            "sample_environment(point).w",
            "environment_density(sample_environment(point).xyz)",
        )
    )
    assert np.abs(np.linalg.norm(drawn, axis=1) - 1.0).max() < 1e-6
    u = 0.5 + np.arctan2(drawn[:, 2], drawn[:, 0]) / (2 * np.pi)
    v = np.arctan2(np.hypot(drawn[:, 0], drawn[:, 2]), drawn[:, 1]) / np.pi
    # At a pole the azimuth is rounding error.
    away = np.abs(v - 0.5) < 0.499
    # Beside the sun the density is steep, and places are rounded.
    assert np.abs(found / claimed - 1.0)[away].max() < 5e-3
    assert claimed * 2 * np.pi**2 * np.sin(v * np.pi) == pytest.approx(
        bilinear(table, np.stack((u, v), axis=-1))[:, 2], rel=5e-3
    )
    # Each half of a cell has a mean density of its own.
    shape = (2 * height, 4 * height)
    counts = np.histogram2d(v, u, bins=shape, range=((0, 1), (0, 1)))[0]
    fine = 16
    places = [(np.arange(n * fine) + 0.5) / (n * fine) for n in shape]
    grid = np.stack(np.meshgrid(*places[::-1]), axis=-1)
    density = bilinear(table, grid)[..., 2]
    means = density.reshape(shape[0], fine, shape[1], fine).mean(axis=(1, 3))
    expected = len(points) * means / means.sum()
    enough = expected > 20
    observed = np.append(counts[enough], counts[~enough].sum())
    wanted = np.append(expected[enough], expected[~enough].sum())
    keep = wanted > 0
    assert stats.chisquare(observed[keep], wanted[keep]).pvalue > 0.001
