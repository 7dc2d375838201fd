"""Intervals and tests against textbook numbers and enumeration."""

import itertools
import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from moka.core.errors import OptionError
from moka.survey.statistics import (
    holm,
    mean_ranks,
    paired_t,
    summarise,
    wilcoxon,
)

#: Hours of sleep gained by a second drug over a first: Student, "The
#: probable error of a mean", Biometrika 1908.
SLEEP = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4]


def test_students_own_example() -> None:
    found = summarise(SLEEP)
    assert found.count == 10
    assert found.mean == pytest.approx(1.58)
    assert found.deviation == pytest.approx(1.229995, abs=1e-6)
    assert found.low == pytest.approx(0.7001142, abs=1e-6)
    assert found.high == pytest.approx(2.4598858, abs=1e-6)
    assert paired_t(SLEEP) == pytest.approx(0.00283289, abs=1e-7)


def test_one_sided_limits_are_those_of_the_table() -> None:
    # t for 9 degrees of freedom at 95 %, one-sided.
    found = summarise(SLEEP)
    error = found.deviation / math.sqrt(10)
    assert (found.mean - found.least) / error == pytest.approx(1.833, abs=5e-4)
    assert found.most - found.mean == pytest.approx(found.mean - found.least)


@given(st.lists(st.floats(-9, 9), min_size=2, max_size=20))
def test_the_interval_holds_zero_where_the_test_finds_nothing(
    sample: list[float],
) -> None:
    found = summarise(sample)
    p = paired_t(sample)
    assert 0.0 <= p <= 1.0
    if abs(p - 0.05) > 1e-9:
        assert (found.low <= 0.0 <= found.high) == (p > 0.05)


def test_no_variation() -> None:
    assert paired_t([0.0, 0.0, 0.0]) == 1.0
    assert paired_t([1.0, 1.0, 1.0]) == 0.0
    assert wilcoxon([0.0, 0.0, 0.0]) == 1.0


def test_one_value_tells_nothing() -> None:
    found = summarise([3.0])
    assert found.mean == 3.0
    assert math.isnan(found.low)
    assert math.isnan(paired_t([3.0]))
    assert math.isnan(wilcoxon([3.0]))


@given(st.lists(st.integers(-3, 3), min_size=2, max_size=9))
def test_wilcoxon_counts_the_signs(sample: list[int]) -> None:
    ranks = stats.rankdata(np.abs(sample))[np.array(sample) != 0]
    positive = sum(
        stats.rankdata(np.abs(sample))[i] for i, d in enumerate(sample) if d > 0
    )
    sums = [
        sum(itertools.compress(ranks, signs))
        for signs in itertools.product((0, 1), repeat=len(ranks))
    ]
    below = sum(each <= positive for each in sums)
    above = sum(each >= positive for each in sums)
    expected = min(1.0, 2 * min(below, above) / len(sums))
    # Thirds, as the means over three scenes are, are ties all the same.
    assert wilcoxon(np.array(sample) / 3) == pytest.approx(expected)


def test_wilcoxon_of_many_agrees_with_the_normal_approximation() -> None:
    sample = np.random.default_rng(5).normal(0.15, 1.0, 150)
    expected = stats.wilcoxon(sample, method="approx", correction=True)
    assert wilcoxon(sample) == pytest.approx(expected.pvalue, abs=2e-3)


def test_holm_steps_down() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx(
        [0.03, 0.06, 0.06, 0.02]
    )
    adjusted = holm([0.6, math.nan, 0.7])
    assert adjusted[0] == adjusted[2] == 1.0
    assert math.isnan(adjusted[1])
    assert holm([]) == []


def test_ranks_share_ties_and_leave_out_what_is_missing() -> None:
    ratings = np.array([[9.0, 7.0, 7.0], [5.0, np.nan, 6.0]])
    assert mean_ranks(ratings).tolist() == [1.5, 2.5, 1.75]


def test_a_missing_package_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(OptionError, match=r"pip install 'moka-pbr\[bench\]'"):
        summarise([1.0, 2.0])
