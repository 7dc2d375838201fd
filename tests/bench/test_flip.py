"""FLIP: what is asked of the authors' package, and what comes back."""

import math
import sys
from collections.abc import Callable

import numpy as np
import pytest

from moka.bench import flip
from moka.core.errors import OptionError

pytest.importorskip("flip_evaluator")


def noise(seed: int, scale: float = 1.0) -> np.ndarray:
    values = np.random.default_rng(seed).random((24, 32, 3)) * scale
    return values.astype(np.float32)


def test_equal_pictures_have_no_error() -> None:
    for function in (flip.flip_display, flip.flip_radiance):
        errors = function(noise(1), noise(1))
        assert errors.shape == (24, 32)
        assert not errors.any()


def test_black_against_white_is_nearly_the_largest_error() -> None:
    # The first paper's redistribution reserves 1 for green against blue.
    black = np.zeros((16, 16, 3), np.float32)
    errors = flip.flip_display(black, black + 1)
    assert errors.min() > 0.95
    green, blue = black.copy(), black.copy()
    green[:, :, 1] = blue[:, :, 2] = 1
    assert flip.flip_display(green, blue).min() == pytest.approx(1, abs=1e-3)


def test_a_small_step_counts_less_than_a_large_one() -> None:
    grey = np.full((16, 16, 3), 0.5, np.float32)
    means = [
        flip.flip_display(grey, grey + np.float32(step)).mean()
        for step in (0.01, 0.05, 0.2)
    ]
    assert 0 < means[0] < means[1] < means[2] < 1


def test_the_exposures_are_those_of_the_package() -> None:
    import flip_evaluator

    # Of an odd number of pixels, so that all agree on what the median is.
    radiance = noise(3, scale=40.0)[:23, :31]
    test = noise(4)[:23, :31]
    _, mean, used = flip_evaluator.evaluate(radiance, test, "HDR")
    start, stop = flip.exposure_range(radiance)
    assert start == pytest.approx(used["startExposure"], abs=1e-5)
    assert stop == pytest.approx(used["stopExposure"], abs=1e-5)
    errors = flip.flip_radiance(radiance, test)
    assert errors.mean() == pytest.approx(mean, abs=1e-5)


def test_start_and_stop_show_0_85_through_aces() -> None:
    radiance = noise(5, scale=300.0)
    values = radiance.astype(np.float64) @ [0.2126, 0.7152, 0.0722]
    for stops, value in zip(
        flip.exposure_range(radiance),
        (values.max(), np.median(values)),
        strict=True,
    ):
        x = 0.6 * value * 2.0**stops
        shown = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
        assert shown == pytest.approx(0.85, abs=1e-9)


def test_a_mostly_black_reference_keeps_finite_exposures() -> None:
    radiance = noise(6)
    radiance[:20] = 0
    start, stop = flip.exposure_range(radiance)
    assert start <= stop < start + 8
    errors = flip.flip_radiance(radiance, radiance * np.float32(1.02))
    assert 0 < errors.mean() < 0.2


@pytest.mark.parametrize("reference", [0.0, 1e-30, 1e30])
def test_extreme_references_have_an_error(reference: float) -> None:
    # The package itself ends the process for a black one.
    flat = np.full((8, 8, 3), reference, np.float32)
    other = np.ones((8, 8, 3), np.float32)
    assert math.isfinite(flip.flip_radiance(flat, other).mean())
    assert flip.flip_radiance(flat, other).min() > 0
    assert not flip.flip_radiance(flat, flat).any()


def test_negative_radiance_counts_as_black() -> None:
    radiance = noise(7) - 0.5
    errors = flip.flip_radiance(radiance, np.maximum(radiance, 0))
    assert not errors.any()


def test_magma_ends() -> None:
    pytest.importorskip("matplotlib")
    colours = flip.magma(np.array([[0.0, 0.5, 1.0, 2.0]]))
    assert colours.dtype == np.uint8
    assert colours[0, 0].tolist() == [0, 0, 4]
    assert colours[0, 2].tolist() == colours[0, 3].tolist() == [252, 253, 191]


@pytest.mark.parametrize(
    ("package", "call"),
    [
        ("flip_evaluator", lambda: flip.flip_display(noise(1), noise(2))),
        ("flip_evaluator", lambda: flip.flip_radiance(noise(1), noise(2))),
        ("matplotlib", lambda: flip.magma(np.zeros((1, 1)))),
    ],
)
def test_a_missing_package_says_how_to_install_it(
    package: str,
    call: Callable[[], object],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # None in its place makes the import of a module fail.
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(OptionError, match=r"pip install 'moka-pbr\[bench\]'"):
        call()
