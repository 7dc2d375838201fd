"""Tone mapping: scene radiance to what a display can show.

Each curve takes linear Rec.709 radiance, already exposed and not negative,
of shape (..., 3), and returns linear display-referred values. sRGB encoding
comes after, the same exact curve for all of them. The shaders hold the same
curves; tests compare the two.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError

__all__ = [
    "TONE_MAPS",
    "aces",
    "agx",
    "exponential",
    "neutral",
    "none",
    "reinhard",
    "tone_map",
]

Colours: TypeAlias = NDArray[np.floating[Any]]

#: What radiance is clamped to after exposure, so that no curve divides one
#: infinity by another. Every curve has long reached white there.
_BRIGHTEST = 1e9


def tone_map(
    radiance: ArrayLike, name: str = "neutral", exposure: float = 0.0
) -> Colours:
    """Radiance times 2^exposure through the curve ``name``, as 0..1.

    ``radiance`` is linear Rec.709, shape (..., 3); float32 stays float32,
    everything else becomes float64. NaN and negative values count as 0.
    The result is linear. Raises OptionError for an unknown curve.
    """
    curve = TONE_MAPS.get(name)
    if curve is None:
        raise OptionError(
            f"unknown tone map {name!r}; known are {', '.join(TONE_MAPS)}"
        )
    values = np.asarray(radiance)
    if values.dtype != np.float32:
        values = values.astype(np.float64, copy=False)
    # What overflows here is as bright as the clamp that follows.
    with np.errstate(over="ignore", invalid="ignore"):
        exposed = values * values.dtype.type(np.exp2(exposure))
    return np.clip(curve(np.fmin(np.fmax(exposed, 0), _BRIGHTEST)), 0, 1)


def none(colour: Colours) -> Colours:
    """No curve; :func:`tone_map` clamps to 0..1."""
    return colour


def exponential(colour: Colours) -> Colours:
    """1 - exp(-x) per channel, the response of film to light."""
    return -np.expm1(-colour)


def reinhard(colour: Colours) -> Colours:
    """x / (1 + x) per channel.

    Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction
    for Digital Images, 2002, equation 3, without its scaling by the key of
    the image, which exposure stands for here.
    """
    return colour / (1.0 + colour)


def neutral(colour: Colours) -> Colours:
    """Khronos PBR Neutral: base colours up to 0.8 come out as they are.

    Khronos, PBR Neutral Tone Mapper specification, 2024. Takes away the
    Fresnel reflection of 0.04, compresses what is above 0.8 - 0.04 and
    desaturates it towards white.
    """
    start = 0.8 - 0.04
    desaturation = 0.15
    darkest = _across_channels(np.minimum, colour)
    offset = np.where(darkest < 0.08, darkest - 6.25 * darkest**2, 0.04)
    base = colour - offset
    peak = _across_channels(np.maximum, base)
    excess = np.maximum(peak - start, 0.0)
    room = 1.0 - start
    # 1 - room^2 / (excess + room), written so that it is exactly peak
    # where nothing exceeds the start.
    new_peak = np.minimum(peak, start) + room * excess / (excess + room)
    scale = np.where(excess > 0.0, new_peak / np.maximum(peak, start), 1.0)
    scaled = base * scale
    white = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0)
    mixed: Colours = scaled + (new_peak - scaled) * white
    return mixed


def aces(colour: Colours) -> Colours:
    """Stephen Hill's fit of the ACES reference and sRGB output transforms.

    Hill, in BakingLab (Narkowicz and Pettineo), ACES.hlsl, 2016. There the
    result is linear too. Exposure is not raised by 1 / 0.6, as some
    renderers do to match the brightness of other curves.
    """
    x = colour @ _ACES_INPUT.astype(colour.dtype).T
    fit = (x * (x + 0.0245786) - 0.000090537) / (
        x * (0.983729 * x + 0.4329510) + 0.238081
    )
    return fit @ _ACES_OUTPUT.astype(colour.dtype).T


def agx(colour: Colours) -> Colours:
    """Troy Sobotka's AgX, base look, by Benjamin Wrensch's polynomial.

    Wrensch, Minimal AgX Implementation, 2023: Rec.709 in, inset matrix,
    log2 between -12.47393 and 4.026069, a polynomial of degree 6 for the
    sigmoid, outset matrix. The result of those is encoded for a display of
    gamma 2.2; it is decoded here, since sRGB encoding follows.
    """
    lowest, highest = -12.47393, 4.026069
    inset = colour @ _AGX_INSET.astype(colour.dtype).T
    # Black has no logarithm; this is far below the lowest value.
    stops = np.log2(np.maximum(inset, 1e-10))
    x = (np.clip(stops, lowest, highest) - lowest) / (highest - lowest)
    sigmoid = np.full_like(x, _AGX_SIGMOID[0])
    for coefficient in _AGX_SIGMOID[1:]:
        sigmoid = sigmoid * x + coefficient
    outset = sigmoid @ _AGX_OUTSET.astype(colour.dtype).T
    return np.maximum(outset, 0.0) ** 2.2


def _across_channels(function: np.ufunc, colour: Colours) -> Colours:
    # Reducing a last axis of three costs NumPy ten times as much.
    red, green, blue = np.moveaxis(colour, -1, 0)
    result: Colours = function(function(red, green), blue)
    return result[..., np.newaxis]


#: The curves by the names of the command line.
TONE_MAPS: dict[str, Callable[[Colours], Colours]] = {
    "neutral": neutral,
    "aces": aces,
    "agx": agx,
    "reinhard": reinhard,
    "exponential": exponential,
    "none": none,
}

_ACES_INPUT = np.array(
    [
        [0.59719, 0.35458, 0.04823],
        [0.07600, 0.90834, 0.01566],
        [0.02840, 0.13383, 0.83777],
    ]
)
_ACES_OUTPUT = np.array(
    [
        [1.60475, -0.53108, -0.07367],
        [-0.10208, 1.10813, -0.00605],
        [-0.00327, -0.07276, 1.07602],
    ]
)
_AGX_INSET = np.array(
    [
        [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
        [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
        [0.0423756549057051, 0.0784336, 0.879142973793104],
    ]
)
_AGX_OUTSET = np.array(
    [
        [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
        [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
        [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
    ]
)
#: From x^6 down to the constant.
_AGX_SIGMOID = (15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232)
