"""How far lit spheres are from the truth, in a few numbers."""

import math
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from moka.bench.flip import flip_display
from moka.bench.spheres import SphereGrid
from moka.core.colour import encode_srgb, luminance
from moka.core.errors import OptionError
from moka.core.tone_map import tone_map

__all__ = ["SphereErrors", "sphere_errors"]

Pixels = NDArray[np.float32]

_MIDDLE_GREY = 0.18


@dataclass(frozen=True, slots=True)
class SphereErrors:
    """Errors of a picture of spheres.

    Over the rough spheres: ``relative_rmse`` is the root mean square error
    of a sphere over its mean radiance, as the mean over spheres; ``median``
    the median over pixels and channels of the relative error; ``bias`` the
    mean over spheres of how much too bright they are, relative; ``maximum``
    the largest error of a channel over its sphere's mean radiance.
    ``mirror`` is ``relative_rmse`` of the spheres of roughness 0. ``flip``
    is the mean FLIP error of all spheres, exposed so that the truth's mean
    luminance is 0.18 and tone mapped; None where flip-evaluator is missing.
    """

    relative_rmse: float
    median: float
    bias: float
    maximum: float
    mirror: float
    flip: float | None

    def as_dict(self) -> dict[str, float | None]:
        """For a JSON file."""
        return {
            name: None if value is None else float(f"{value:.5g}")
            for name, value in asdict(self).items()
        }


def sphere_errors(
    grid: SphereGrid, truth: Pixels, picture: Pixels
) -> SphereErrors:
    """Compare two pictures (H, W, 4) of radiance of ``grid``'s facets.

    The top row is first. The grid has spheres of roughness 0 and others.
    """
    rough = np.array(grid.roughnesses) > 0.0
    expected, found = (
        grid.pixels(each).astype(np.float64)[..., :3]
        for each in (truth, picture)
    )
    difference = found - expected
    scale = expected.mean(axis=(2, 3))
    rmse = np.sqrt(np.mean(difference**2, axis=(2, 3))) / scale
    lit = expected[:, rough] > 0.0
    relative = np.abs(difference[:, rough][lit]) / expected[:, rough][lit]
    largest = np.abs(difference).max(axis=(2, 3)) / scale
    return SphereErrors(
        relative_rmse=float(rmse[:, rough].mean()),
        median=float(np.median(relative)),
        bias=float((difference.mean(axis=(2, 3)) / scale)[:, rough].mean()),
        maximum=float(largest[:, rough].max()),
        mirror=float(rmse[:, ~rough].mean()),
        flip=_flip(grid, truth, picture),
    )


def _flip(grid: SphereGrid, truth: Pixels, picture: Pixels) -> float | None:
    mean = float(luminance(grid.pixels(truth)[..., :3]).mean())
    exposure = math.log2(_MIDDLE_GREY / mean) if mean > 0.0 else 0.0
    shown = [
        encode_srgb(tone_map(each[:, :, :3], "neutral", exposure))
        for each in (truth, picture)
    ]
    try:
        errors = flip_display(*shown)
    except OptionError:
        return None
    return float(grid.pixels(errors[:, :, np.newaxis]).mean())
