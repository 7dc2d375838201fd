"""How rough a mip level of a normal map has to look for what it averages.

A texel of a level stands for many normals. Their mean points the right way,
but a highlight on it is as narrow as on a mirror, where all of them together
scatter light: bumps that are too far away to be seen make a surface rougher.
The shorter the mean of unit vectors, the wider they spread.

Sources: Toksvig 2005, "Mipmapping Normal Maps"; Olano and Baker 2010, "LEAN
Mapping": variances of slopes add up, and alpha^2 of a lobe is one; Banerjee
et al. 2005, "Clustering on the Unit Hypersphere using von Mises-Fisher
Distributions", for the concentration of normals whose mean has length r.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.mip_levels import halve_exactly

__all__ = ["normal_filter", "slope_variance"]

#: Rows worked on at a time, as values.
_BLOCK = 1 << 16


def slope_variance(squared_length: Any) -> Any:
    """What a spread of normals adds to alpha^2, 0 to 1.

    ``squared_length`` is that of the mean of unit normals, of any shape. They
    are taken for a von Mises-Fisher lobe of concentration k = r (3 - r^2) /
    (1 - r^2), whose slopes have the variance 1 / k along each axis. A
    Gaussian lobe would grow by 2 / k. GGX, whose own variance is infinite,
    grows by half of that: then least light lies wrong, by an angle of 0.3 to
    0.7 of what it is without (first Wasserstein distance).
    """
    squared = np.clip(squared_length, 0.0, 1.0)
    length = np.sqrt(squared)
    spread, narrow = 1.0 - squared, length * (3.0 - squared)
    return np.minimum(spread / np.maximum(narrow, 1e-6), 1.0)


def normal_filter(
    texels: NDArray[Any], *, scale: float, roughness_factor: float | None
) -> Callable[[NDArray[np.uint16], NDArray[Any]], None]:
    """What :func:`moka.core.mip_levels.reduce_levels` finishes levels with.

    ``texels`` (H, W, 4) of uint8 or uint16 are normals with something in
    their alpha, ``scale`` is that of the material. With ``roughness_factor``
    the alpha is the roughness that this factor is multiplied with: it becomes
    that of the lobe as wide as all that the texel covers, as far as it has
    room below 1. Without, it becomes 1 - sqrt(what is added to alpha^2).
    """
    white = float(np.iinfo(texels.dtype).max)
    # A level's 16-bit values of white.
    unit = 65535.0 if texels.dtype == np.uint16 else 256.0 * white
    squares = [_first_squares(texels, white)]

    def finish(linear: NDArray[np.uint16], codes: NDArray[Any]) -> None:
        if squares[0].shape[:2] != linear.shape[:2]:
            squares[0] = halve_exactly(squares[0])
        length = _squared_length(linear, unit)
        added = slope_variance(length / np.maximum(squares[0][:, :, 0], 1e-6))
        added = np.minimum(scale * scale * added, 1.0)
        if roughness_factor is None:
            alpha = 1.0 - np.sqrt(added)
        else:
            rough = linear[:, :, 3] * np.float32(roughness_factor / unit)
            wide = np.minimum(rough**4 + added, 1.0) ** 0.25
            alpha = np.minimum(wide / max(roughness_factor, 1e-6), 1.0)
        codes[:, :, 3] = np.rint(white * alpha)

    return finish


def _first_squares(texels: NDArray[Any], white: float) -> NDArray[np.float32]:
    """Mean squared lengths (h, w, 1) of the normals under each texel.

    Of the first level; lengths differ from 1 by rounding, and more in images
    that are not well made.
    """
    height, width, _ = texels.shape
    # In blocks, so that temporaries stay in the cache.
    step = height if height % 2 else 2 * max(1, _BLOCK // (2 * width))
    return np.concatenate(
        [
            halve_exactly(
                _squared_length(texels[start : start + step], white)[..., None]
            )
            for start in range(0, height, step)
        ]
    )


def _squared_length(codes: NDArray[Any], white: float) -> NDArray[np.float32]:
    """Squared lengths (h, w) of the vectors in codes (h, w, C)."""
    total = np.zeros(codes.shape[:2], np.float32)
    for channel in range(3):
        value = codes[:, :, channel] * np.float32(2.0 / white)
        value -= np.float32(1)
        value *= value
        total += value
    return total
