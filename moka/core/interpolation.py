"""Values between values, over whole arrays in float64.

Source: glTF 2.0 specification, appendix C (animation sampler interpolation
modes).
"""

import numpy as np

from moka.core.maths import Array

__all__ = ["hermite", "lerp", "slerp"]


def lerp(first: Array, second: Array, fraction: Array) -> Array:
    """Values (..., C) on the straight way; exact at both of its ends.

    ``fraction`` (...) is 0 at ``first`` and 1 at ``second``.
    """
    along = fraction[..., None]
    return np.asarray((1 - along) * first + along * second, np.float64)


def slerp(first: Array, second: Array, fraction: Array) -> Array:
    """Unit quaternions (..., 4) on the shorter great circle between two.

    Spherical linear interpolation (Shoemake 1985, "Animating rotation with
    quaternion curves"). A quaternion and its negative are one rotation, so
    of the two ways the shorter one is taken; the angle comes from the chord,
    which is exact where the cosine has lost small angles.
    """
    cosine = np.einsum("...i,...i->...", first, second)
    second = np.where(cosine[..., None] < 0, -second, second)
    chord = second - first
    length = np.sqrt(np.einsum("...i,...i->...", chord, chord))
    angle = 2 * np.arcsin(np.minimum(0.5 * length, 1))
    sine = np.sin(angle)
    safe = np.where(sine > 0, sine, 1)
    start = np.where(
        sine > 0, np.sin((1 - fraction) * angle) / safe, 1 - fraction
    )
    end = np.where(sine > 0, np.sin(fraction * angle) / safe, fraction)
    return np.asarray(start[..., None] * first + end[..., None] * second)


def hermite(
    first: Array,
    leaving: Array,
    arriving: Array,
    second: Array,
    fraction: Array,
    span: Array,
) -> Array:
    """Values (..., C) on a cubic Hermite spline between two keyframes.

    ``leaving`` and ``arriving`` (..., C) are the tangents at ``first`` and
    at ``second``, per unit of time, and ``span`` (...) is the time between
    the two.
    """
    t, duration = fraction[..., None], span[..., None]
    squared, cubed = t * t, t * t * t
    return np.asarray(
        (2 * cubed - 3 * squared + 1) * first
        + duration * (cubed - 2 * squared + t) * leaving
        + (3 * squared - 2 * cubed) * second
        + duration * (cubed - squared) * arriving,
        np.float64,
    )
