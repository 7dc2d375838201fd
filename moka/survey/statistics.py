"""Means, intervals and paired tests of differences, in float64.

The distributions are SciPy's. Everything is two-sided at 95 % unless said
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
    return 2.0 * float(_scipy("special").stdtr(summary.count - 1, -t))


def wilcoxon(differences: ArrayLike) -> float:
    """The p-value of the signed-rank test, with Pratt's way with zeros.

    Wilcoxon 1945; Pratt, "Remarks on zeros and ties in the Wilcoxon signed
    rank procedures", 1959. It asks less of the ratings than the t-test:
    that differences can be ranked, not that their means are normal.
    """
    sample = np.asarray(differences, np.float64)
    if sample.size < 2:
        return math.nan
    if not sample.any():
        return 1.0
    test = _scipy("stats").wilcoxon(sample, zero_method="pratt")
    return float(test.pvalue)


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

    NaN is not ranked.
    """
    ranks = _scipy("stats").rankdata(-ratings, axis=1, nan_policy="omit")
    mean: NDArray[np.float64] = np.nanmean(ranks, axis=0)
    return mean


def _student_quantile(freedom: int, probability: float) -> float:
    return float(_scipy("special").stdtrit(freedom, probability))


def _scipy(module: str) -> Any:
    try:
        if module == "stats":
            from scipy import stats as found
        else:
            from scipy import special as found
    except ImportError as error:
        raise OptionError(
            "the analysis needs the package scipy: "
            "pip install 'moka-pbr[bench]'"
        ) from error
    return found
