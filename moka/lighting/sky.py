"""The built-in ``sky``: a clear day over a plain of grey soil.

Preetham, Shirley and Smits, A Practical Analytic Model for Daylight,
SIGGRAPH 1999: luminance and chromaticity of the sky (section 3, appendix
A.2), and what the air leaves of the sun (appendix A.1).
"""

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.colour import XYZ_TO_REC709, luminance
from moka.lighting.environment import Environment, Sun
from moka.lighting.equirectangular import solid_angles, texel_directions

__all__ = ["sky"]

Array = NDArray[np.floating[Any]]

_HEIGHT = 256

#: Luminance Y and chromaticity x, y: A to E of Perez' formula, each as
#: slope * turbidity + offset (appendix A.2).
_PEREZ = np.array(
    [
        [
            (0.1787, -1.4630),
            (-0.3554, 0.4275),
            (-0.0227, 5.3251),
            (0.1206, -2.5771),
            (-0.0670, 0.3703),
        ],
        [
            (-0.0193, -0.2592),
            (-0.0665, 0.0008),
            (-0.0004, 0.2125),
            (-0.0641, -0.8989),
            (-0.0033, 0.0452),
        ],
        [
            (-0.0167, -0.2608),
            (-0.0950, 0.0092),
            (-0.0079, 0.2102),
            (-0.0441, -1.6537),
            (-0.0109, 0.0529),
        ],
    ]
)

#: Chromaticity x, y of the zenith: rows for turbidity squared, turbidity
#: and 1, columns for the cube of the sun's zenith angle down to 1.
_ZENITH_X = np.array(
    [
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]
)
_ZENITH_Y = np.array(
    [
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]
)

#: Micrometres that stand for red, green and blue in the air's absorption,
#: and what ozone absorbs of them per centimetre.
_WAVELENGTHS = np.array([0.61, 0.55, 0.465])
_OZONE = np.array([0.120, 0.085, 0.009])

#: Klx of the sun above the air.
_SOLAR_CONSTANT = 128.0
_SUN_RADIUS = math.radians(0.2665)

#: Of dry soil.
_GROUND_ALBEDO = np.array([0.29, 0.25, 0.20])

#: Towards the horizon haze covers the ground, by this angle to 1 / e.
_HAZE = math.radians(1.5)

#: A white horizontal surface under sun and sky has this radiance.
_WHITE = 1.4


@cache
def sky(
    elevation: float = math.radians(42.0),
    azimuth: float = math.radians(128.0),
    turbidity: float = 2.2,
) -> Environment:
    """A clear sky and its sun, which is a light and not in the map.

    The sun stands ``elevation`` radians (above 0) over the horizon and
    ``azimuth`` radians from +X towards +Z, by default in front of a model
    that faces +Z, to the left of who looks at it. ``turbidity`` is 2 for
    clear and 10 for hazy air. Radiance is relative: a white horizontal
    surface outdoors has a radiance of 1.4, which needs no exposure.
    """
    if not 0.0 < elevation <= math.pi / 2.0:
        raise ValueError("the sun of this sky stands above the horizon")
    towards_sun = np.array(
        [
            math.cos(elevation) * math.cos(azimuth),
            math.sin(elevation),
            math.cos(elevation) * math.sin(azimuth),
        ]
    )
    directions = texel_directions(_HEIGHT, 2 * _HEIGHT)
    horizon = _HEIGHT // 2
    above = _sky_radiance(directions[:horizon], towards_sun, turbidity)
    sun = _SOLAR_CONSTANT * _transmittance(elevation, turbidity)

    cosines = directions[:horizon, 0, 1]
    weights = solid_angles(_HEIGHT, 2 * _HEIGHT)[:horizon, 0]
    irradiance = (weights * cosines) @ above.sum(axis=1)
    irradiance += sun * math.sin(elevation)
    ground = _GROUND_ALBEDO * irradiance / math.pi
    haze = np.exp(np.arcsin(directions[horizon:, :1, 1:2]) / _HAZE)
    below = ground + haze * (above[-1] - ground)

    scale = _WHITE * math.pi / float(luminance(irradiance))
    pixels = np.concatenate([above, below]) * scale
    red, green, blue = (sun * scale).tolist()
    x, y, z = towards_sun.tolist()
    return Environment(
        pixels.astype(np.float32),
        (Sun((x, y, z), (red, green, blue), _SUN_RADIUS),),
        "sky",
    )


def _sky_radiance(
    directions: Array, towards_sun: Array, turbidity: float
) -> Array:
    """Luminance in kcd per square metre, as linear Rec.709 (H, W, 3).

    Perez' formula for the sky over the zenith: a gradation from horizon to
    zenith, which rows share, times a glow around the sun.
    """
    a, b, c, d, e = (_PEREZ @ [turbidity, 1.0]).T  # of Y, x and y each
    sun_angle = math.acos(towards_sun[1])
    zenith = _zenith(sun_angle, turbidity) / (
        (1.0 + a * np.exp(b))
        * (1.0 + c * np.exp(d * sun_angle) + e * towards_sun[1] ** 2)
    )
    gradation = zenith * (1.0 + a * np.exp(b / directions[:, :1, 1:2]))
    cosine = np.clip(directions @ towards_sun, -1.0, 1.0)[..., np.newaxis]
    glow = 1.0 + c * np.exp(d * np.arccos(cosine)) + e * cosine**2
    sky = gradation * glow
    height, x, y = sky[..., 0], sky[..., 1], sky[..., 2]
    xyz = np.stack([x * height / y, height, (1.0 - x - y) * height / y], -1)
    radiance: Array = np.maximum(xyz @ XYZ_TO_REC709.T, 0.0)
    return radiance


def _zenith(sun_angle: float, turbidity: float) -> Array:
    """Luminance Y (kcd per square metre), x and y of the zenith."""
    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * sun_angle)
    powers = sun_angle ** np.arange(3, -1, -1)
    turbidities = turbidity ** np.arange(2, -1, -1)
    return np.array(
        [
            (4.0453 * turbidity - 4.9710) * math.tan(chi)
            - 0.2155 * turbidity
            + 2.4192,
            turbidities @ _ZENITH_X @ powers,
            turbidities @ _ZENITH_Y @ powers,
        ]
    )


def _transmittance(elevation: float, turbidity: float) -> Array:
    """What the air leaves of the sun's red, green and blue light.

    Appendix A.1: scattering by molecules and by aerosols, and absorption by
    ozone; the mixed gases and water vapour matter in the infrared only.
    """
    degrees = 90.0 - math.degrees(elevation)
    mass = 1.0 / (math.sin(elevation) + 0.15 * (93.885 - degrees) ** -1.253)
    beta = 0.04608365822050 * turbidity - 0.04586025928522
    depth = (
        0.008735 * _WAVELENGTHS**-4.08
        + beta * _WAVELENGTHS**-1.3
        + 0.35 * _OZONE
    )
    left: Array = np.exp(-depth * mass)
    return left
