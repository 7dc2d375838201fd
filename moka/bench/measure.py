"""What a series of measurements says: middle, spread, ratios, growth."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Ratio",
    "Spread",
    "growth_exponent",
    "milliseconds_in_turn",
    "ratio_of_pairs",
    "spread",
]

Array = NDArray[np.float64]

_RESAMPLES = 2000


@dataclass(frozen=True, slots=True)
class Spread:
    """Order statistics of a series, in its unit."""

    median: float
    quartile_1: float
    quartile_3: float
    minimum: float
    p95: float
    count: int

    def as_dict(self) -> dict[str, float]:
        """For a JSON file, rounded to what a clock can tell."""
        return {
            name: round(float(getattr(self, name)), 4)
            for name in self.__slots__
        }


@dataclass(frozen=True, slots=True)
class Ratio:
    """A ratio and its 95 % confidence interval."""

    value: float
    low: float
    high: float

    def as_dict(self) -> dict[str, float]:
        """For a JSON file."""
        return {
            "ratio": round(self.value, 4),
            "low": round(self.low, 4),
            "high": round(self.high, 4),
        }

    def __str__(self) -> str:
        return f"{self.value:.3f} ({self.low:.3f} to {self.high:.3f})"


def spread(values: ArrayLike) -> Spread:
    """Median, quartiles, minimum and 95th percentile of ``values`` (N,).

    Quantiles are interpolated linearly between neighbours (definition 7 of
    Hyndman and Fan 1996). Raises ValueError for an empty series.
    """
    series = np.asarray(values, np.float64).ravel()
    if not len(series):
        raise ValueError("a series without values has no spread")
    low, middle, high, p95 = np.percentile(series, (25, 50, 75, 95))
    return Spread(
        float(middle),
        float(low),
        float(high),
        float(series.min()),
        float(p95),
        len(series),
    )


def milliseconds_in_turn(
    jobs: Mapping[str, Callable[[], object]], rounds: int
) -> dict[str, dict[str, float]]:
    """The spread of each job's time, run A B A B.

    The first round, which is not counted, fills caches.
    """
    times: dict[str, list[float]] = {name: [] for name in jobs}
    for number in range(1 + rounds):
        for name, job in jobs.items():
            start = time.perf_counter()
            job()
            if number:
                times[name].append(1000.0 * (time.perf_counter() - start))
    return {name: spread(each).as_dict() for name, each in times.items()}


def ratio_of_pairs(values: ArrayLike, base: ArrayLike) -> Ratio:
    """How many times ``base`` (N,) the ``values`` (N,) are.

    Pairs belong together: they were measured one after the other, so that
    what slows the machine slows both. The value is the median of the ratios
    of pairs, its interval a percentile bootstrap over pairs (Efron and
    Tibshirani 1993, chapter 13), always drawn alike. One pair has no
    interval: its bounds are the value itself.
    """
    ratios = np.asarray(values, np.float64) / np.asarray(base, np.float64)
    generator = np.random.default_rng(0)
    drawn = generator.integers(0, len(ratios), (_RESAMPLES, len(ratios)))
    medians = np.median(ratios[drawn], axis=1)
    low, high = np.percentile(medians, (2.5, 97.5))
    return Ratio(float(np.median(ratios)), float(low), float(high))


def growth_exponent(sizes: ArrayLike, times: ArrayLike) -> float:
    """The b of times ~ a sizes^b, by least squares of logarithms.

    Over the larger half of the sizes (at least two): at small ones what a
    frame costs anyway hides the growth. NaN for fewer than two sizes.
    """
    x = np.log(np.asarray(sizes, np.float64))
    y = np.log(np.asarray(times, np.float64))
    if len(x) < 2:
        return float("nan")
    kept = np.argsort(x)[-max(2, -(-len(x) // 2)) :]
    slope: float = np.polyfit(x[kept], y[kept], 1)[0]
    return float(slope)
