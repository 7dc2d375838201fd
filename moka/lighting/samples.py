"""Sample lists for prefiltering an environment, made once per level.

In tangent space the samples of a lobe at n = v = r are the same for every
texel of a level. They are computed here in float64, so that the shader is
left with one texture read per sample and no branch.

Each sample reads the mip level whose texels cover about the solid angle the
sample stands for: Křivánek and Colbert 2008, "Real-time Shading with
Filtered Importance Sampling". That is what keeps a small sun from turning
into spots.
"""

from math import pi

import numpy as np
from numpy.typing import NDArray

__all__ = ["cosine_samples", "ggx_prefilter_samples", "hammersley", "pack"]

Samples = NDArray[np.float32]

# Samples read this many mip levels above their share of the lobe, which hides
# the gaps between them and blurs. Křivánek and Colbert's section 4 has 1.
# Measured against sums over all texels, 64 samples, roughness 0.125 to 1: for
# maps cut at 8 times their mean 0 has errors of 1 to 4 %, 0.5 of 1.5 to 6 %,
# 1 of 2 to 8 %; for a map with its sun 26 to 70, 17 to 82, 28 to 70 %. In
# pictures of spheres, relative RMSE at roughness 0.1 and 0.2: beach 0.037 and
# 0.034 with 0, 0.043 and 0.037 with 0.5; studio 0.083 and 0.080, 0.094 and
# 0.090.
OVERLAP = 0.0


def hammersley(count: int) -> NDArray[np.float64]:
    """Hammersley's point set: (count, 2) points inside the unit square.

    The points lie in the middle of their cells, as in
    ``shaders/include/sampling.glsl``.
    """
    index = np.arange(count, dtype=np.uint32)
    inverse = np.zeros(count)
    digit = 0.5
    remaining = index.copy()
    while remaining.any():
        inverse += digit * (remaining & 1)
        remaining >>= 1
        digit /= 2.0
    return np.stack((index / count, inverse), axis=-1) + 0.5 / count


def ggx_prefilter_samples(
    roughness: float,
    count: int,
    source_size: int,
    *,
    overlap: float = OVERLAP,
) -> Samples:
    """Samples of a GGX lobe at n = v = r for ``prefilter_specular.frag``.

    Returns float32 of shape (M, 4), M <= ``count``. The first three columns
    are a direction around (0, 0, 1), scaled so that z is the weight of the
    sample (n.l, and their sum is 1), which a cube map lookup does not mind.
    The last is the level to read of a cube map whose faces have
    ``source_size`` texels along an edge at level 0. Samples below the
    horizon are dropped. Roughness 0 is one sample in the direction itself.

    The half vectors have density D n.h (Walter et al. 2007, equation 35),
    the directions D n.h / (4 v.h), which is D / 4 because v = n.
    """
    alpha = roughness * roughness
    if alpha == 0.0:
        return np.array([[0.0, 0.0, 1.0, 0.0]], np.float32)
    azimuth, height = hammersley(count).T
    scale = 1.0 + (alpha * alpha - 1.0) * height
    sine = alpha * np.sqrt(height / scale)
    cosine = np.sqrt((1.0 - height) / scale)
    n_dot_l = 2.0 * cosine * cosine - 1.0
    above = n_dot_l > 0.0
    radius = 2.0 * cosine * sine
    # D in a form that does not cancel; with (n.h)^2 = (1 - u) / scale its
    # denominator n.h^2 (alpha^2 - 1) + 1 is alpha^2 / scale.
    density = scale * scale / (4.0 * pi * alpha * alpha)
    direction = _around_z(azimuth, radius, n_dot_l)[above]
    levels = _levels(density[above], count, source_size, overlap)
    weighted = direction / n_dot_l[above].sum()
    return np.column_stack((weighted, levels)).astype(np.float32)


def cosine_samples(
    count: int, source_size: int, *, overlap: float = OVERLAP
) -> Samples:
    """Samples with density n.l / pi for ``prefilter_irradiance.frag``.

    Returns float32 of shape (count, 4): a unit direction around (0, 0, 1)
    and the level to read, as :func:`ggx_prefilter_samples`. All samples
    weigh the same.
    """
    azimuth, height = hammersley(count).T
    n_dot_l = np.sqrt(1.0 - height)
    direction = _around_z(azimuth, np.sqrt(height), n_dot_l)
    levels = _levels(n_dot_l / pi, count, source_size, overlap)
    return np.column_stack((direction, levels)).astype(np.float32)


def pack(samples: Samples, capacity: int) -> bytes:
    """``samples`` as the std140 block ``PrefilterSamples``.

    ``capacity`` is the shader's ``MOKA_SAMPLE_COUNT``. The block is an
    integer, padded to 16 bytes, and ``capacity`` vectors of four floats.
    """
    if len(samples) > capacity:
        raise ValueError(
            f"{len(samples)} samples do not fit a block of {capacity}"
        )
    header = np.array([len(samples), 0, 0, 0], np.int32)
    block = np.zeros((capacity, 4), np.float32)
    block[: len(samples)] = samples
    return header.tobytes() + block.tobytes()


def _around_z(
    turns: NDArray[np.float64],
    radius: NDArray[np.float64],
    z: NDArray[np.float64],
) -> NDArray[np.float64]:
    angle = 2.0 * pi * turns
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle), z))


def _levels(
    density: NDArray[np.float64], count: int, source_size: int, overlap: float
) -> NDArray[np.float64]:
    """Where a texel covers 1 / (count density) steradians, plus overlap."""
    of_texel = 4.0 * pi / (6.0 * source_size * source_size)
    ratio = 1.0 / (count * density * of_texel)
    return np.maximum(0.5 * np.log2(ratio) + overlap, 0.0)
