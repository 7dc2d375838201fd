"""Mip levels of colours with alpha: what is transparent does not bleed.

The colour of a level is the mean of the colours that it covers, each with
the weight of its alpha: under a cut-out leaf lies a colour that nobody chose.
Where alpha is compared with a cutoff, the mean of many alphas would eat up
leaves with distance, so that the alphas of each level are scaled until as
many texels pass as in the image itself: Castaño 2010, "Computing Alpha
Mipmaps".
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.colour import decode_srgb, encode_srgb8
from moka.core.mip_levels import halve_exactly

__all__ = ["reduce_alpha_levels"]

#: Rows worked on at a time, as values of all their channels.
_BLOCK = 1 << 20

#: What counts of a transparent colour, so that there is a mean without any
#: other. To 8 bits it is nothing beside an alpha of 1.
_EPSILON = np.float32(2.0**-20)


def reduce_alpha_levels(
    texels: NDArray[np.uint8], *, cutoff: float | None = None, finest: int = 0
) -> list[NDArray[Any]]:
    """The chain of mip levels of sRGB-encoded RGBA, from ``finest`` on.

    ``texels`` is uint8 of shape (H, W, 4), and so are the levels, each half
    as large as the one before, rounded down. Colours are averaged in linear
    light with the weight of their alpha, alphas as they are; with ``cutoff``
    in 0 to 1 each level keeps the part of texels whose alpha reaches it.
    """
    levels: list[NDArray[Any]] = [] if finest else [texels]
    covered = _coverage(texels, cutoff) if cutoff else 0.0
    weighted: NDArray[np.float32] | None = None
    for level in range(1, max(texels.shape[:2]).bit_length()):
        weighted = (
            _first_level(texels)
            if weighted is None
            else halve_exactly(weighted)
        )
        if level < finest:
            continue
        encoded = np.empty(weighted.shape, np.uint8)
        alpha = weighted[:, :, 3]
        encoded[:, :, :3] = encode_srgb8(weighted[:, :, :3] / alpha[..., None])
        alpha = np.clip((alpha - _EPSILON) / (1 - _EPSILON), 0, 1)
        if cutoff:
            alpha = _keep_coverage(alpha, cutoff, covered)
        encoded[:, :, 3] = np.rint(255.0 * alpha)
        levels.append(encoded)
    return levels


def _first_level(texels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Weighted linear colours and weights (h, w, 4) of half the size."""
    height, width, _ = texels.shape
    if height % 2:
        return halve_exactly(_weigh(texels))
    # In blocks: the image is four times as large as what comes out.
    step = 2 * max(1, _BLOCK // (8 * width))
    return np.concatenate(
        [
            halve_exactly(_weigh(texels[start : start + step]))
            for start in range(0, height, step)
        ]
    )


def _weigh(texels: NDArray[np.uint8]) -> NDArray[np.float32]:
    codes = np.arange(256) / 255.0
    weighted = decode_srgb(codes).astype(np.float32).take(texels)
    alpha = (codes * (1 - _EPSILON) + _EPSILON).astype(np.float32)
    weighted[:, :, 3] = alpha.take(texels[:, :, 3])
    weighted[:, :, :3] *= weighted[:, :, 3:]
    return weighted


def _coverage(texels: NDArray[np.uint8], cutoff: float) -> float:
    """The part of texels whose alpha is at least ``cutoff``."""
    counts = np.bincount(texels[:, :, 3].reshape(-1), minlength=256)
    return float(counts[_reaching(cutoff) :].sum() / counts.sum())


def _reaching(cutoff: float) -> int:
    """The least code of alpha that passes; 256 if none does."""
    return min(256, math.ceil(255.0 * cutoff - 1e-6))


def _keep_coverage(
    alpha: NDArray[np.float32], cutoff: float, covered: float
) -> NDArray[np.float32]:
    """Alphas scaled so that the part ``covered`` of them reaches ``cutoff``."""
    count = round(covered * alpha.size)
    if not 0 < count < alpha.size:
        return alpha
    least = np.partition(alpha, -count, axis=None)[-count]
    if least <= 0:
        return alpha
    scaled = alpha * np.float32(_reaching(cutoff) / 255.0 / least)
    np.minimum(scaled, np.float32(1), out=scaled)
    return scaled
