"""Sample lists: densities, weights and levels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.lighting.samples import (
    cosine_samples,
    ggx_prefilter_samples,
    hammersley,
    pack,
)


@pytest.mark.parametrize("count", [1, 3, 64, 500])
def test_hammersley_points_are_inside_and_each_in_its_own_row(count):
    points = hammersley(count)
    assert points.shape == (count, 2)
    assert (points > 0.0).all()
    assert (points < 1.0).all()
    rows = np.floor(points[:, 0] * count)
    assert len(set(rows)) == count


def test_hammersley_integrates():
    x, y = hammersley(256).T
    assert np.mean(np.exp(x) * np.cos(y)) == pytest.approx(
        (np.e - 1.0) * np.sin(1.0), rel=5e-3
    )


@given(
    roughness=st.floats(1e-3, 1.0),
    count=st.integers(1, 300),
    size=st.sampled_from([1, 16, 256, 1024]),
)
def test_specular_samples_are_directions_whose_weights_sum_to_one(
    roughness, count, size
):
    samples = ggx_prefilter_samples(roughness, count, size)
    assert samples.dtype == np.float32
    assert 1 <= len(samples) <= count
    assert np.isfinite(samples).all()
    assert (samples[:, 2] > 0.0).all()
    assert (samples[:, 3] >= 0.0).all()
    assert samples[:, 2].sum() == pytest.approx(1.0, rel=1e-5)
    # All are scaled alike, so that z is the cosine but for one factor.
    length = np.linalg.norm(samples[:, :3], axis=1)
    assert length == pytest.approx(length[0], rel=1e-5)


def test_roughness_zero_is_a_mirror():
    assert ggx_prefilter_samples(0.0, 64, 256).tolist() == [[0, 0, 1, 0]]


@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.7, 1.0])
def test_specular_samples_have_the_mean_cosine_of_their_lobe(roughness):
    """Against sums over half vectors on a fine grid, weighted D n.h n.l."""
    samples = ggx_prefilter_samples(roughness, 1024, 256)
    cosine = samples[:, 2] / np.linalg.norm(samples[:, :3], axis=1)
    mean = np.sum(cosine * samples[:, 2])

    theta = (np.arange(200_000) + 0.5) / 200_000 * np.pi / 4.0
    tangent = np.tan(theta)
    alpha = roughness**2
    d = 1.0 / (np.cos(theta) ** 4 * (alpha**2 + tangent**2) ** 2)
    n_dot_l = np.cos(2.0 * theta)
    weight = d * np.cos(theta) * np.sin(theta) * n_dot_l
    expected = np.sum(weight * n_dot_l) / np.sum(weight)
    assert mean == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
def test_specular_levels_follow_the_density_of_the_samples(roughness):
    """D / 4 per steradian: the pdf of l where v = n, with no 1 / pi more."""
    count, size, overlap = 200, 256, 1.0
    samples = ggx_prefilter_samples(roughness, count, size, overlap=overlap)
    unit = samples[:, :3] / np.linalg.norm(samples[:, :3], axis=1)[:, None]
    h = unit + np.array([0.0, 0.0, 1.0])
    cosine = h[:, 2] / np.linalg.norm(h, axis=1)
    alpha = roughness**2
    d = alpha**2 / (np.pi * (cosine**2 * (alpha**2 - 1.0) + 1.0) ** 2)
    per_sample = 1.0 / (count * d / 4.0)
    per_texel = 4.0 * np.pi / (6.0 * size**2)
    level = np.maximum(0.5 * np.log2(per_sample / per_texel) + overlap, 0.0)
    assert samples[:, 3] == pytest.approx(level, abs=2e-3)


def test_samples_stand_for_the_whole_lobe():
    """Dropped samples leave their share to nobody: levels count them."""
    samples = ggx_prefilter_samples(1.0, 400, 256)
    # Half of the half vectors of roughness 1 reflect below the horizon.
    assert len(samples) == pytest.approx(200, abs=2)


def test_cosine_samples_are_unit_vectors_distributed_like_the_cosine():
    samples = cosine_samples(512, 64)
    assert samples.shape == (512, 4)
    assert np.linalg.norm(samples[:, :3], axis=1) == pytest.approx(1.0)
    # The mean of z under density z / pi is 2 / 3, that of z^2 1 / 2.
    assert samples[:, 2].mean() == pytest.approx(2.0 / 3.0, abs=1e-3)
    assert (samples[:, 2] ** 2).mean() == pytest.approx(0.5, abs=1e-3)
    assert samples[:, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-2)


def test_a_uniform_density_would_read_the_level_of_its_share():
    """The zenith of the cosine lobe: density 1 / pi, 96 texels of 6 64^2."""
    samples = cosine_samples(81, 64, overlap=0.0)
    share = np.pi / 81
    texel = 4.0 * np.pi / (6 * 64 * 64)
    level = 0.5 * np.log2(share / texel)
    assert samples[:, 3].min() == pytest.approx(level, abs=0.02)


def test_pack_is_the_std140_block():
    samples = cosine_samples(3, 64)
    block = pack(samples, 5)
    assert len(block) == 16 + 5 * 16
    assert np.frombuffer(block[:4], np.int32)[0] == 3
    vectors = np.frombuffer(block[16:], np.float32).reshape(5, 4)
    assert np.array_equal(vectors[:3], samples)
    assert not vectors[3:].any()


def test_pack_refuses_what_does_not_fit():
    with pytest.raises(ValueError, match="4 samples do not fit"):
        pack(cosine_samples(4, 64), 3)
