"""RGBE: three mantissas of 8 bits that share one exponent.

Ward, Real Pixels, Graphics Gems II, 1991. A mantissa m with the exponent e
is m * 2^(e - 136): like most readers, and unlike Radiance itself, this adds
no half to the mantissa, so that black and powers of two are exact.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["decode_rgbe", "encode_rgbe"]

#: By exponent: what a mantissa counts. The exponent 0 means black.
_SCALE = np.ldexp(1.0, np.arange(256) - 136).astype(np.float32)
_SCALE[0] = 0.0


def decode_rgbe(rgbe: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Float32 colours (..., 3) of ``rgbe`` (..., 4), exactly."""
    scale = _SCALE.take(rgbe[..., 3])
    colours = np.empty((*rgbe.shape[:-1], 3), np.float32)
    for channel in range(3):
        np.multiply(rgbe[..., channel], scale, out=colours[..., channel])
    return colours


def encode_rgbe(colours: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """The nearest RGBE (..., 4) of ``colours`` (..., 3).

    Negative values and NaN become 0, what is too large for the format its
    largest value, near 1.7e38.
    """
    largest = 255.0 * float(_SCALE[255])
    values = np.fmin(np.fmax(colours.astype(np.float64), 0.0), largest)
    peak = values.max(axis=-1)
    _, exponent = np.frexp(peak)
    # A mantissa that rounds up to 256 needs the next exponent.
    exponent += np.rint(np.ldexp(peak, 8 - exponent)) == 256.0
    exponent += 128
    visible = (exponent > 0) & (peak > 0.0)
    rgbe = np.zeros((*peak.shape, 4), np.uint8)
    mantissas = np.rint(np.ldexp(values, 136 - exponent[..., np.newaxis]))
    np.copyto(
        rgbe[..., :3],
        mantissas,
        where=visible[..., np.newaxis],
        casting="unsafe",
    )
    np.copyto(rgbe[..., 3], exponent, where=visible, casting="unsafe")
    return rgbe
