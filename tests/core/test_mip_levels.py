"""Mip levels against area averages of the texels in float64."""

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.core.colour import decode_srgb, encode_srgb
from moka.core.mip_levels import reduce_levels
from moka.core.shared_work import shared_with


def noise(*shape: int, dtype: type = np.uint8) -> np.ndarray:
    random = np.random.default_rng(sum(shape))
    values = random.uniform(0.0, 1.0, shape) ** 3
    return np.rint(values * np.iinfo(dtype).max).astype(dtype)


def shrink(values: np.ndarray, axis: int) -> np.ndarray:
    """Averages over intervals of equal length, whatever the old size."""
    values = np.moveaxis(values, axis, 0)
    old, new = len(values), max(1, len(values) // 2)
    edges = np.linspace(0.0, old, new + 1)
    cells = np.arange(old)
    overlap = np.minimum(edges[1:, None], cells + 1) - np.maximum(
        edges[:-1, None], cells
    )
    weights = np.maximum(overlap, 0.0) * new / old
    return np.moveaxis(np.tensordot(weights, values, 1), 0, axis)


def oracle(texels: np.ndarray, srgb: bool) -> list[np.ndarray]:
    """The levels, unrounded, as values of 0..1."""
    values = texels / np.iinfo(texels.dtype).max
    colour = values.shape[2] - (values.shape[2] in (2, 4))
    if srgb:
        values[:, :, :colour] = decode_srgb(values[:, :, :colour])
    levels = []
    while max(values.shape[:2]) > 1:
        values = shrink(shrink(values, 0), 1)
        encoded = values.copy()
        if srgb:
            encoded[:, :, :colour] = encode_srgb(values[:, :, :colour])
        levels.append(encoded)
    return levels


def check(texels: np.ndarray, srgb: bool) -> None:
    levels = reduce_levels(texels, srgb=srgb)
    assert levels[0] is texels
    expected = oracle(texels, srgb)
    assert len(levels) == len(expected) + 1
    for level, exact in zip(levels[1:], expected, strict=True):
        assert level.dtype == texels.dtype
        assert level.shape == exact.shape
        assert level.flags.c_contiguous
        # Half a code of rounding, and a little for the 16 bits in between.
        white = np.iinfo(level.dtype).max
        tolerance = 0.65 if level.dtype == np.uint8 else 4.0
        assert np.abs(level - white * exact).max() < tolerance


@given(
    st.integers(1, 21),
    st.integers(1, 21),
    st.integers(1, 4),
    st.booleans(),
)
def test_levels_are_area_averages(
    height: int, width: int, channels: int, srgb: bool
) -> None:
    check(noise(height, width, channels), srgb)


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize(
    "shape", [(256, 512, 3), (130, 1024, 4), (1, 300, 1), (300, 1, 3)]
)
def test_large_images(shape: tuple[int, ...], srgb: bool) -> None:
    check(noise(*shape), srgb)


@given(st.integers(1, 17), st.integers(1, 17), st.integers(1, 4))
def test_sixteen_bits(height: int, width: int, channels: int) -> None:
    check(noise(height, width, channels, dtype=np.uint16), srgb=False)


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("size", [(64, 64), (61, 35)])
def test_one_value_stays_itself(srgb: bool, size: tuple[int, int]) -> None:
    for value in range(0, 256, 15):
        texels = np.full((*size, 4), value, np.uint8)
        for level in reduce_levels(texels, srgb=srgb):
            assert (level == value).all()


def test_colours_are_averaged_as_light_and_alpha_as_it_is() -> None:
    texels = np.zeros((2, 2, 4), np.uint8)
    texels[0] = 255
    assert reduce_levels(texels, srgb=True)[1].tolist() == [
        [[188, 188, 188, 128]]
    ]
    assert reduce_levels(texels)[1].tolist() == [[[128, 128, 128, 128]]]


def test_srgb_of_sixteen_bits_is_refused() -> None:
    with pytest.raises(ValueError, match="8 bits"):
        reduce_levels(noise(2, 2, 3, dtype=np.uint16), srgb=True)


@pytest.mark.parametrize("shape", [(64, 32, 4), (31, 20, 3)])
def test_levels_from_the_finest_wanted_on(shape: tuple[int, ...]) -> None:
    texels = noise(*shape)
    whole = reduce_levels(texels, srgb=True)
    for finest in range(len(whole)):
        part = reduce_levels(texels, srgb=True, finest=finest)
        assert len(part) == len(whole) - finest
        for level, same in zip(part, whole[finest:], strict=True):
            np.testing.assert_array_equal(level, same)


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("channels", [3, 4])
def test_levels_of_several_threads_are_the_same(
    channels: int, srgb: bool
) -> None:
    texels = noise(1024, 2048, channels)
    threads = set()

    with ThreadPoolExecutor(2) as pool:
        share = shared_with(pool)

        def run(function: Callable[[int], None], pieces: Iterable[int]) -> None:
            def piece(number: int) -> None:
                threads.add(threading.current_thread().name)
                function(number)

            share(piece, pieces)

        shared = reduce_levels(texels, srgb=srgb, run=run)
    assert len(threads) > 1
    for level, same in zip(
        shared, reduce_levels(texels, srgb=srgb), strict=True
    ):
        np.testing.assert_array_equal(level, same)


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("shape", [(64, 256), (48, 40), (13, 6)])
def test_opaque_colours_are_those_of_white_alpha(
    shape: tuple[int, int], srgb: bool
) -> None:
    texels = noise(*shape, 4)
    texels[:, :, 3] = 255
    for level, same in zip(
        reduce_levels(texels, srgb=srgb, opaque=True),
        reduce_levels(texels, srgb=srgb),
        strict=True,
    ):
        np.testing.assert_array_equal(level, same)


@pytest.mark.parametrize("value", [1, 2, 3, 20, 128, 254])
def test_rounding_does_not_add_up(value: int) -> None:
    """Eleven levels of texels of two neighbouring codes."""
    texels = np.full((2048, 64, 4), value, np.uint8)
    texels[::2, ::2] += 1
    exact = oracle(texels[:2, :2], srgb=True)[0] * 255
    for level in reduce_levels(texels, srgb=True)[1:]:
        assert np.abs(level - exact).max() < 0.65
