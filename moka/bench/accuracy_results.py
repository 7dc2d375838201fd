"""Results of ``moka bench accuracy``: averaged, as a table and as JSON."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from moka.bench.lighting_measure import Measurement
from moka.bench.lighting_modes import LightingMode
from moka.bench.pareto import pareto_front
from moka.bench.results import format_table
from moka.bench.spheres import SphereGrid
from moka.version import __version__

__all__ = [
    "Point",
    "UnderEnvironment",
    "as_json",
    "format_results",
    "mean_points",
]


@dataclass(frozen=True, slots=True)
class UnderEnvironment:
    """What was measured under one environment.

    ``truth_samples`` is what a pixel of the truth had.
    """

    name: str
    truth_samples: int
    measurements: tuple[Measurement, ...]

    @property
    def title(self) -> str:
        """Its name without folders."""
        return Path(self.name).stem

    @property
    def truth_error(self) -> float:
        """The relative RMSE of the truth itself, at most.

        Taken from the reference mode with the most samples, whose error
        falls at least like one over the square root of their number.
        """
        last = max(self.measurements, key=lambda each: each.mode.samples)
        ratio = last.mode.samples / self.truth_samples
        return last.errors.relative_rmse * math.sqrt(ratio)


@dataclass(frozen=True, slots=True)
class Point:
    """One mode's means over environments, a point of the chart.

    ``picture_front`` and ``first_front`` say whether nothing else is plainly
    better in relative RMSE or in the time of a picture, or of the first.
    """

    mode: LightingMode
    relative_rmse: float
    median: float
    preintegration_ms: float
    picture_ms: float
    picture_front: bool
    first_front: bool

    @property
    def first_ms(self) -> float:
        """The time of the first picture of an environment."""
        return self.preintegration_ms + self.picture_ms


def mean_points(results: Sequence[UnderEnvironment]) -> list[Point]:
    """Means over environments, which all have the same modes."""
    means = [
        (
            same[0].mode,
            *np.mean(
                [
                    (
                        each.errors.relative_rmse,
                        each.errors.median,
                        each.preintegration_ms,
                        each.picture_ms,
                    )
                    for each in same
                ],
                axis=0,
            ).tolist(),
        )
        for same in zip(
            *(result.measurements for result in results), strict=True
        )
    ]
    picture = pareto_front([(each[4], each[1]) for each in means])
    first = pareto_front([(each[3] + each[4], each[1]) for each in means])
    return [
        Point(*each, *fronts)
        for each, *fronts in zip(means, picture, first, strict=True)
    ]


def format_results(results: Sequence[UnderEnvironment]) -> str:
    """A table for each environment and one of their means."""
    parts = []
    for result in results:
        parts.append(
            f"{result.title}: relative RMSE of the truth below "
            f"{result.truth_error:.2g}"
        )
        parts.append(
            format_table(
                (
                    "mode",
                    "rel. RMSE",
                    "median",
                    "bias",
                    "max",
                    "mirror",
                    "FLIP",
                    "preint. ms",
                    "picture ms",
                ),
                [_row(each) for each in result.measurements],
            )
        )
    parts.append("mean over environments (* on the front of error and time)")
    parts.append(
        format_table(
            (
                "mode",
                "quality",
                "rel. RMSE",
                "median",
                "picture ms",
                "*",
                "first ms",
                "* ",
            ),
            [
                (
                    point.mode.name,
                    point.mode.quality or "",
                    point.relative_rmse,
                    point.median,
                    point.picture_ms,
                    "*" if point.picture_front else "",
                    point.first_ms,
                    "*" if point.first_front else "",
                )
                for point in mean_points(results)
            ],
        )
    )
    return "\n".join(parts)


def _row(each: Measurement) -> tuple[object, ...]:
    errors = each.errors
    return (
        each.mode.name,
        errors.relative_rmse,
        errors.median,
        f"{errors.bias:+.4f}",
        errors.maximum,
        errors.mirror,
        "-" if errors.flip is None else errors.flip,
        each.preintegration_ms,
        each.picture_ms,
    )


def as_json(
    grid: SphereGrid, results: Sequence[UnderEnvironment]
) -> dict[str, Any]:
    """What the JSON file holds."""
    return {
        "benchmark": "accuracy",
        "moka": __version__,
        "size": list(grid.size),
        "roughnesses": list(grid.roughnesses),
        "materials": [each.name for each in grid.substances],
        "environments": {
            result.title: {
                "truth_samples": result.truth_samples,
                "truth_error": round(result.truth_error, 5),
                "modes": {
                    each.mode.name: {
                        **each.errors.as_dict(),
                        "preintegration_ms": round(each.preintegration_ms, 3),
                        "picture_ms": round(each.picture_ms, 3),
                    }
                    for each in result.measurements
                },
            }
            for result in results
        },
        "mean": {
            point.mode.name: {
                "settings": point.mode.knobs,
                "quality": point.mode.quality,
                "relative_rmse": round(point.relative_rmse, 5),
                "median": round(point.median, 5),
                "preintegration_ms": round(point.preintegration_ms, 3),
                "picture_ms": round(point.picture_ms, 3),
                "on_front_of_picture_time": point.picture_front,
                "on_front_of_first_picture_time": point.first_front,
            }
            for point in mean_points(results)
        },
    }
