"""Importance sampling of an environment map: alias tables as textures.

A direction is drawn with a density proportional to the luminance of the
map as it is read, with bilinear interpolation: a texel from an alias table
(Walker 1977; Vose 1991), then a place around its centre, distributed like
the tent that the texel is in the interpolated map. One texel of the table
says all, so the shader draws in constant time, however small the sun, where
a search in cumulative sums would read twenty texels. A density that is
constant in a texel would do too, but its samples of a sun of one texel had a
relative standard deviation of 1; these have next to none.

``shaders/include/importance.glsl`` is the other half.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LARGEST_HEIGHT", "alias_table", "cell_weights", "importance_table"]

Array = NDArray[np.float64]

#: Cells along the height of a table. Larger maps share one cell among
#: several texels, which costs variance and no bias: 16 bytes a cell and one
#: read a sample are to stay small against the map itself.
LARGEST_HEIGHT = 1024

# Rec.709. What matters to the eye decides where samples go.
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def importance_table(pixels: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """The table (h, w, 4) of a map (H, W, 3) of linear Rec.709 radiance.

    Top row first, as the map. Of each cell it holds the probability to stay
    there, column and row of the cell to go to otherwise, and the density at
    its centre, over texture coordinates. A black map is sampled uniformly.
    (h, w) is (H, W) divided by a whole number that keeps h up to
    :data:`LARGEST_HEIGHT` and divides both.
    """
    weights = cell_weights(pixels)
    height, width = weights.shape
    stay, alias = alias_table(weights.ravel())
    table = np.empty((height * width, 4), np.float32)
    table[:, 0] = stay
    table[:, 1] = alias % width
    table[:, 2] = alias // width
    table[:, 3] = weights.ravel() * (weights.size / weights.sum())
    return table.reshape(height, width, 4)


def cell_weights(pixels: NDArray[np.floating[Any]]) -> Array:
    """The share of the light (h, w), up to a factor, that cells have.

    Luminance times the sine of the polar angle, by which an area of the map
    is one of the sphere. Never all zero.
    """
    height, width = pixels.shape[:2]
    sine = np.sin((np.arange(height) + 0.5) / height * np.pi)[:, np.newaxis]
    light = (np.asarray(pixels, np.float64) @ _LUMINANCE) * sine
    if not light.any():
        light = np.broadcast_to(sine, light.shape)
    step = _cell_size(height, width)
    cells = light.reshape(height // step, step, width // step, step)
    weights: Array = cells.sum(axis=(1, 3))
    return weights


def alias_table(weights: Array) -> tuple[Array, NDArray[np.intp]]:
    """Probability to stay (N,) and alias (N,) of each of N items.

    Drawing an item uniformly, and its alias instead unless a uniform number
    is below its probability to stay, gives item i with probability
    ``weights[i] / weights.sum()``. Weights are not negative, nor all zero.

    This is the sweep of Hübschle-Schneider and Sanders 2019, "Parallel
    Weighted Random Sampling", section 4.2, written as cumulative sums: light
    items are filled up in order from heavy ones in order, and a heavy item
    that has given too much becomes light and is filled from the next.
    """
    count = len(weights)
    scaled = weights * (count / weights.sum())
    light = np.flatnonzero(scaled <= 1.0)
    heavy = np.flatnonzero(scaled > 1.0)
    stay = np.minimum(scaled, 1.0)
    alias = np.arange(count)
    if not len(heavy):
        return stay, alias
    missing = np.cumsum(1.0 - scaled[light])
    surplus = np.cumsum(scaled[heavy] - 1.0)
    # A light item takes from the first heavy one that has any left.
    before = np.concatenate(([0.0], missing[:-1]))
    giver = np.searchsorted(surplus, before, side="right")
    # Both sums end equal up to rounding, which the last one absorbs.
    alias[light] = heavy[np.minimum(giver, len(heavy) - 1)]
    # The light item that takes more than a heavy one has left.
    last = np.searchsorted(missing, surplus[:-1], side="left")
    taken = missing[np.minimum(last, len(light) - 1)]
    stay[heavy[:-1]] = np.clip(1.0 - (taken - surplus[:-1]), 0.0, 1.0)
    alias[heavy[:-1]] = heavy[1:]
    return stay, alias


def _cell_size(height: int, width: int) -> int:
    """Texels along the edge of a cell: the least that divide the map."""
    step = -(-height // LARGEST_HEIGHT)
    while height % step or width % step:
        step += 1
    return step
