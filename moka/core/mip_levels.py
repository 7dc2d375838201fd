"""Mip levels of textures, reduced on the CPU in worker threads.

A driver in software needs longer to generate them than these few passes
over the texels take here, and it does not promise linear light. Between
levels texels are 16-bit linear values, so that eleven roundings do not add
up; all heavy steps are NumPy calls that release the interpreter's lock.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.colour import decode_srgb, encode_srgb8
from moka.core.shared_work import Run, run_here

__all__ = ["halve_exactly", "reduce_levels"]

Finish = Callable[[NDArray[np.uint16], NDArray[Any]], None]

#: Values worked on at a time, so that temporaries stay in the cache.
_BLOCK = 1 << 16

#: White in 16 bits: what rounding adds to it must not carry over.
_WHITE = 65532


def reduce_levels(
    texels: NDArray[Any],
    *,
    srgb: bool = False,
    opaque: bool = False,
    finish: Finish | None = None,
    finest: int = 0,
    run: Run = run_here,
) -> list[NDArray[Any]]:
    """The chain of mip levels, from ``texels`` itself down to 1 x 1.

    ``texels`` is uint8 or uint16 of shape (H, W, C), and so are the levels,
    each half as large as the one before, rounded down. Every texel is the
    mean of the area it covers: 2 x 2 texels, or up to 3 x 3 with weights
    where a size is odd (Guthe and Heckbert, Non-Power-of-Two Mipmapping,
    NVIDIA 2005). ``srgb`` texels, of 8 bits, are averaged in linear light,
    a last channel of two or four always as it is; ``opaque`` says that it is
    white throughout. ``finest`` is the first level wanted; those before it are
    left out. ``finish`` is called with the 16-bit linear values of each level
    and its codes, which it may change. ``run`` does the larger levels in
    blocks.
    """
    if srgb and texels.dtype != np.uint8:
        raise ValueError("sRGB-encoded texels have 8 bits")
    levels = [] if finest else [texels]
    linear: NDArray[np.uint16] | None = None
    for level in range(1, max(texels.shape[:2]).bit_length()):
        if linear is not None:
            linear = _halve(linear, texels.dtype, run)
        elif _has_lanes(texels) and texels.dtype == np.uint8:
            linear = _decode_and_halve(
                texels, srgb=srgb, opaque=opaque, run=run
            )
        else:
            linear = _halve(_decode(texels, srgb), texels.dtype, run)
        if level < finest and finish is None:
            continue
        codes = _encode(linear, texels.dtype, srgb, run)
        if finish is not None:
            finish(linear, codes)
        if level >= finest:
            levels.append(codes)
    return levels


def _has_lanes(texels: NDArray[Any]) -> bool:
    """Whether texels are four channels in a block of even sizes."""
    return texels.shape[2] == 4 and not _has_odd_size(texels)


def _has_odd_size(texels: NDArray[Any]) -> bool:
    height, width, _ = texels.shape
    return bool(height % 2 or width % 2)


def _has_alpha(texels: NDArray[Any]) -> bool:
    return texels.shape[2] in (2, 4)


def _decode(texels: NDArray[Any], srgb: bool) -> NDArray[np.uint16]:
    """Texels as 16-bit linear values.

    8-bit data become 256 times as large, decoded colours end at 65535.
    """
    if texels.dtype == np.uint16:
        return texels
    scaled: NDArray[np.uint16] = texels.astype(np.uint16)
    scaled <<= 8
    if srgb:
        colour = slice(-1 if _has_alpha(texels) else None)
        table = np.rint(_WHITE * decode_srgb(np.arange(256) / 255.0))
        decoded = table.astype(np.uint16).take(texels[:, :, colour])
        scaled[:, :, colour] = decoded
    return scaled


def _decode_and_halve(
    texels: NDArray[np.uint8], *, srgb: bool, opaque: bool, run: Run
) -> NDArray[np.uint16]:
    """The first level of 8-bit RGBA of even sizes, as 16-bit values.

    Three quarters of all the work is here. Four channels of a texel are added
    at once as one number of 64 bits, data as they are. Colours are looked up,
    two channels at once.
    """
    height, width, _ = texels.shape
    texels = np.ascontiguousarray(texels)
    linear = np.empty((height // 2, width // 2, 4), np.uint16)
    step = max(1, _BLOCK // (2 * width))

    def block(start: int) -> None:
        rows = texels[2 * start : 2 * (start + step)]
        target = linear[start : start + step]
        if not srgb:
            sums = np.add(rows[0::2], rows[1::2], dtype=np.uint16)
            sums <<= 6
            _add_columns(sums, target)
            return
        pairs = rows.reshape(len(rows), -1).view(np.uint16)
        decoded = _quarters().take(pairs, mode="clip").view(np.uint64)
        _add_columns(decoded[0::2] + decoded[1::2], target)
        if opaque:
            target[:, :, 3] = 255 << 8
        else:
            alpha = np.add(rows[0::2, :, 3], rows[1::2, :, 3], dtype=np.uint16)
            alpha <<= 6
            np.add(alpha[:, 0::2], alpha[:, 1::2], out=target[:, :, 3])

    run(block, range(0, height // 2, step))
    return linear


def _add_columns(texels: NDArray[Any], target: NDArray[np.uint16]) -> None:
    """Sums of two neighbours each, of RGBA whose sums stay below 2^16."""
    height = len(texels)
    lanes = texels.reshape(height, -1).view(np.uint64)
    half = target.reshape(height, -1).view(np.uint64)
    np.add(lanes[:, 0::2], lanes[:, 1::2], out=half)


@cache
def _quarters() -> NDArray[np.uint32]:
    """A quarter of what each of two sRGB codes decodes to, beside each other.

    By their bytes as one number. Four quarters stay below 2^16.
    """
    linear = decode_srgb(np.arange(256) / 255.0)
    quarter = np.rint(0.25 * _WHITE * linear).astype(np.uint32)
    pairs: NDArray[np.uint32] = quarter | quarter[:, np.newaxis] << 16
    return pairs.reshape(-1)


def _halve(
    linear: NDArray[np.uint16], dtype: np.dtype[Any], run: Run
) -> NDArray[np.uint16]:
    """The next level of 16-bit linear values of any size.

    Of texels of 8 bits a quarter of the steps in between is enough, so that
    four values add up without a carry.
    """
    if _has_odd_size(linear):
        exact = halve_exactly(linear.astype(np.float32))
        return np.rint(exact).astype(np.uint16, order="C")
    height, width, channels = linear.shape
    halved: NDArray[np.uint16] = np.empty(
        (height // 2, width // 2, channels), np.uint16
    )
    step = max(1, _BLOCK // (width * channels))

    def block(start: int) -> None:
        rows = linear[2 * start : 2 * (start + step)]
        if dtype == np.uint8 and channels == 4:
            # Half of the rows rounded up, and half of them down.
            upper, lower = rows[0::2] + np.uint16(2), rows[1::2] + np.uint16(1)
            upper >>= 2
            lower >>= 2
            upper += lower
            _add_columns(upper, halved[start : start + step])
            return
        sums = np.add(rows[0::2], rows[1::2], dtype=np.uint32)
        for channel in range(channels):
            total = sums[:, 0::2, channel] + sums[:, 1::2, channel]
            total += 2
            total >>= 2
            halved[start : start + step, :, channel] = total

    run(block, range(0, height // 2, step))
    return halved


def halve_exactly(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """The next level (h, w, C) of values of any size, not rounded."""
    return _halve_rows(_halve_rows(values).swapaxes(0, 1)).swapaxes(0, 1)


def _halve_rows(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Half as many rows, weighted by how much of each lies in a new one."""
    height = len(values)
    half = height // 2
    if height == 1:
        return values
    if height % 2 == 0:
        return (values[0::2] + values[1::2]) * np.float32(0.5)
    # A new row covers 2 + 1 / half of the old ones.
    index = np.arange(half, dtype=np.float32).reshape(half, 1, 1)
    total: NDArray[np.float32] = (
        (half - index) * values[0:-1:2]
        + half * values[1::2]
        + (index + 1) * values[2::2]
    )
    return total / np.float32(height)


def _encode(
    linear: NDArray[np.uint16], dtype: np.dtype[Any], srgb: bool, run: Run
) -> NDArray[Any]:
    if dtype == np.uint16:
        return linear.copy()
    codes = np.empty(linear.shape, np.uint8)
    table = _encoding_table() if srgb else None
    step = max(1, _BLOCK // linear[0].size)

    def block(start: int) -> None:
        rows, target = linear[start : start + step], codes[start : start + step]
        if table is not None:
            # Checking indices would make a copy of them.
            table.take(rows, out=target, mode="clip")
        if table is None or _has_alpha(linear):
            plain = slice(-1 if srgb else None, None)
            target[:, :, plain] = (rows[:, :, plain] + np.uint16(128)) >> 8

    run(block, range(0, len(linear), step))
    return codes


@cache
def _encoding_table() -> NDArray[np.uint8]:
    """The 8-bit sRGB code of every 16-bit linear value."""
    return encode_srgb8(np.arange(65536) / 65535.0)
