"""Spreads, ratios and growth against what their definitions say."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.bench.measure import growth_exponent, ratio_of_pairs, spread


def test_the_spread_of_known_numbers() -> None:
    found = spread([4.0, 1.0, 3.0, 2.0, 5.0])
    assert (found.median, found.quartile_1, found.quartile_3) == (3, 2, 4)
    assert found.minimum == 1
    assert found.p95 == pytest.approx(4.8)
    assert found.count == 5


def test_a_series_without_values_has_no_spread() -> None:
    with pytest.raises(ValueError, match="without values"):
        spread([])


def test_a_ratio_holds_its_interval_and_repeats() -> None:
    generator = np.random.default_rng(1)
    machine = generator.lognormal(0.0, 0.5, 40)  # slow for both of a pair
    base = machine * generator.lognormal(0.0, 0.02, 40)
    other = 1.25 * machine * generator.lognormal(0.0, 0.02, 40)
    ratio = ratio_of_pairs(other, base)
    assert ratio.low <= 1.25 <= ratio.high
    assert ratio.high - ratio.low < 0.03
    assert ratio == ratio_of_pairs(other, base)


def test_one_pair_has_no_interval() -> None:
    assert ratio_of_pairs([3.0], [2.0]).as_dict() == {
        "ratio": 1.5,
        "low": 1.5,
        "high": 1.5,
    }


@given(st.floats(0.0, 3.0), st.floats(0.01, 100.0))
def test_the_exponent_of_a_power_law(exponent: float, factor: float) -> None:
    sizes = np.array([10.0, 100.0, 1000.0, 10000.0])
    found = growth_exponent(sizes, factor * sizes**exponent)
    assert found == pytest.approx(exponent, abs=1e-9)


def test_a_constant_cost_at_small_sizes_does_not_hide_growth() -> None:
    sizes = np.array([1.0, 2.0, 4.0, 4e4, 4e5, 4e6])
    assert growth_exponent(sizes, 50.0 + sizes) == pytest.approx(1, abs=0.01)


def test_one_size_has_no_growth() -> None:
    assert math.isnan(growth_exponent([10.0], [1.0]))
