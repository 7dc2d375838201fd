"""Shaders' polynomials are the best of their degree."""

import numpy as np
import pytest

from moka.core.colour import encode_srgb
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


def test_the_srgb_curve_is_the_best_of_degree_6_in_a_fourth_root() -> None:
    joint = 0.0031308
    best, error = minimax(
        lambda root: encode_srgb(root**4), range(7), joint**0.25, 1.0
    )
    # Of a step of 8 bits a 2 000th.
    assert error < 1.5e-6
    light = np.linspace(joint + 1e-6, 1.0, 5000)
    value = gpu().evaluate("srgb_encode(x)", "srgb", x=[[x] * 3 for x in light])
    fitted = light[:, None] ** (0.25 * np.arange(7)) @ best
    assert np.abs(value[:, 0] - fitted).max() < ROUNDING
