"""Means, intervals and paired tests of differences, in float64.

Student's distribution is SciPy's. Everything is two-sided at 95 % unless said
otherwise; what a single value cannot tell is NaN.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError

__all__ = ["Summary", "holm", "mean_ranks", "paired_t", "summarise", "wilcoxon"]

LEVEL = 0.95

#: Means of whole ratings that are equal differ by less than this rounds to.
_DECIMALS = 9


@dataclass(frozen=True)
class Summary:
    """Mean, standard deviation and Student's interval of a sample.

    ``low`` and ``high`` bound the two-sided 95 % interval of the mean;
    ``least`` and ``most`` are the one-sided 95 % limits, which together are
    the 90 % interval that two one-sided tests at 5 % need.
    """

    count: int
    mean: float
    deviation: float
    low: float
    high: float
    least: float
    most: float


def summarise(values: ArrayLike) -> Summary:
    """The summary of one value per participant, at least one."""
    sample = np.asarray(values, np.float64)
    count, mean = sample.size, float(sample.mean())
    if count < 2:
        return Summary(count, mean, *[math.nan] * 5)
    deviation = float(sample.std(ddof=1))
    error = deviation / math.sqrt(count)
    two_sided = _student_quantile(count - 1, 0.5 + LEVEL / 2) * error
    one_sided = _student_quantile(count - 1, LEVEL) * error
    return Summary(
        count,
        mean,
        deviation,
        mean - two_sided,
        mean + two_sided,
        mean - one_sided,
        mean + one_sided,
    )


def paired_t(differences: ArrayLike) -> float:
    """The p-value of Student's paired t-test: is the mean difference 0?

    Where all differences are equal it is 1 if they are 0, else 0.
    """
    summary = summarise(differences)
    if summary.count < 2:
        return math.nan
    error = summary.deviation / math.sqrt(summary.count)
    if error == 0.0:
        return 1.0 if summary.mean == 0.0 else 0.0
    t = abs(summary.mean) / error
    return 2.0 * float(_special().stdtr(summary.count - 1, -t))


def wilcoxon(differences: ArrayLike) -> float:
    """The p-value of the signed-rank test, exact also with ties and zeros.

    Wilcoxon 1945; zeros take part in the ranking and are then left out, as
    in Pratt, "Remarks on zeros and ties in the Wilcoxon signed rank
    procedures", 1959. It asks less of the ratings than the t-test: that
    differences can be ranked, not that their means are normal.
    """
    sample = np.round(np.asarray(differences, np.float64), _DECIMALS)
    if sample.size < 2:
        return math.nan
    # Shared ranks end in a half at most, so that twice a rank is whole.
    doubled = np.rint(2.0 * _ranks(np.abs(sample))).astype(int)
    positive = int(doubled[sample > 0.0].sum())
    # The chance of each sum, if every sign is as likely as the other.
    chances = np.ones(1)
    for rank in doubled[sample != 0.0]:
        grown = np.zeros(chances.size + rank)
        grown[: chances.size] += 0.5 * chances
        grown[rank:] += 0.5 * chances
        chances = grown
    tails = chances[: positive + 1].sum(), chances[positive:].sum()
    return min(1.0, 2.0 * float(min(tails)))


def holm(values: Sequence[float]) -> list[float]:
    """p-values adjusted for their number (Holm 1979); NaN stays NaN."""
    order = sorted(
        (index for index, p in enumerate(values) if not math.isnan(p)),
        key=lambda index: values[index],
    )
    adjusted = list(values)
    largest = 0.0
    for place, index in enumerate(order):
        scaled = (len(order) - place) * values[index]
        largest = max(largest, min(1.0, scaled))
        adjusted[index] = largest
    return adjusted


def mean_ranks(ratings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean ranks (R,) of ratings (N, R): 1 is the best, ties share.

    NaN is not ranked; every column needs one that is.
    """
    ranks = np.full(ratings.shape, np.nan)
    for row, places in zip(ratings, ranks, strict=True):
        given = ~np.isnan(row)
        places[given] = _ranks(-np.round(row[given], _DECIMALS))
    mean: NDArray[np.float64] = np.nanmean(ranks, axis=0)
    return mean


def _ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ranks from 1 for the smallest; equal values share their mean rank."""
    _, inverse, counts = np.unique(
        values, return_inverse=True, return_counts=True
    )
    shared: NDArray[np.float64] = np.cumsum(counts) - (counts - 1) / 2.0
    return shared[inverse]


def _student_quantile(freedom: int, probability: float) -> float:
    return float(_special().stdtrit(freedom, probability))


def _special() -> Any:
    try:
        from scipy import special
    except ImportError as error:
        raise OptionError(
            "the analysis needs the package scipy: "
            "pip install 'moka-pbr[bench]'"
        ) from error
    return special
