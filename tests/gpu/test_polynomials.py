"""Shaders' polynomials are the best of their degree."""

import numpy as np
import pytest

from tests.support.gpu import gpu
from tests.support.oracles.minimax import minimax

pytestmark = pytest.mark.gpu

# Of float32, after a dozen operations.
ROUNDING = 2.5e-7


def test_the_arctangent_is_the_best_of_degree_13() -> None:
    powers = range(1, 14, 2)
    best, error = minimax(lambda x: np.arctan(x) / np.pi, powers, 1e-6, 1.0)
    assert error < 8e-8
    x = np.linspace(-1.0, 1.0, 5000)
    value = gpu().evaluate(
        "arctangent_over_pi(x)", "environment", x=np.stack((x, -x), axis=-1)
    )
    fitted = x[:, None] ** np.array(powers) @ best
    assert np.abs(value[:, 0] - fitted).max() < ROUNDING
    assert np.array_equal(value[:, 0], -value[:, 1])
