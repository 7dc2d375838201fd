"""The plain metrics against their formulas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.bench.metrics import psnr, relative_rmse, rmse

VALUES = st.lists(
    st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)), min_size=1
)


def test_equal_pictures_have_no_error() -> None:
    values = np.random.default_rng(1).random((5, 4, 3))
    assert rmse(values, values) == 0.0
    assert relative_rmse(values, values) == 0.0
    assert psnr(values, values) == math.inf


@given(VALUES)
def test_the_formulas(pairs: list[tuple[float, float]]) -> None:
    first, second = np.array(pairs).T
    mean = math.fsum((b - a) ** 2 for a, b in pairs) / len(pairs)
    # Squares of differences below 1e-154 vanish in the oracle only.
    assert rmse(first, second) == pytest.approx(
        math.sqrt(mean), rel=1e-12, abs=1e-150
    )
    if mean > 1e-100:
        power = math.fsum(a * a for a, _ in pairs) / len(pairs)
        expected = math.sqrt(mean / power) if power else math.inf
        assert psnr(first, second, 2.0) == pytest.approx(
            10.0 * math.log10(4.0 / mean), abs=1e-9
        )
        if power > 1e-100:
            assert relative_rmse(first, second) == pytest.approx(expected)


def test_huge_differences_do_not_overflow() -> None:
    assert rmse([1e300, -1e300], [-0.5e300, 0.5e300]) == pytest.approx(1.5e300)


def test_a_black_reference() -> None:
    assert relative_rmse([0.0], [1.0]) == math.inf
    assert relative_rmse([0.0], [0.0]) == 0.0
    assert psnr([0.0], [1.0], 0.0) == -math.inf


def test_half_a_code_of_noise_in_float32_is_not_lost() -> None:
    # A sum of float32 squares would stall after some millions of them.
    first = np.zeros((2048, 2048), np.float32)
    assert rmse(first, first + np.float32(1 / 510)) == pytest.approx(
        1 / 510, rel=1e-6
    )


def test_shapes_must_agree() -> None:
    with pytest.raises(ValueError, match=r"\(1,\) and \(2,\) differ"):
        rmse([1.0], [1.0, 2.0])
    with pytest.raises(ValueError, match="nothing"):
        rmse([], [])
