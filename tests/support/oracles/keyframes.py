"""Keyframes of glTF one channel at a time, in Python's own numbers.

Written from appendix C of the glTF 2.0 specification; nothing here knows of
arrays of channels.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def sample(
    times: Sequence[float],
    values: ArrayLike,
    interpolation: str,
    time: float,
    *,
    rotates: bool = False,
) -> Array:
    """The value (C,) of one channel; cubic splines have (K, 3, C) values."""
    keys = np.asarray(values, np.float64)
    spline = interpolation == "CUBICSPLINE"
    plain = keys[:, 1] if spline else keys
    last = len(times) - 1
    if time <= times[0]:
        return _unit(plain[0]) if rotates else plain[0]
    if time >= times[last]:
        return _unit(plain[last]) if rotates else plain[last]
    key = max(index for index in range(last) if times[index] <= time)
    span = times[key + 1] - times[key]
    t = (time - times[key]) / span
    if interpolation == "STEP":
        return _unit(plain[key]) if rotates else plain[key]
    if interpolation == "LINEAR":
        if rotates:
            return _shortest(_unit(plain[key]), _unit(plain[key + 1]), t)
        return plain[key] + t * (plain[key + 1] - plain[key])
    value = (
        (2 * t**3 - 3 * t**2 + 1) * keys[key, 1]
        + span * (t**3 - 2 * t**2 + t) * keys[key, 2]
        + (-2 * t**3 + 3 * t**2) * keys[key + 1, 1]
        + span * (t**3 - t**2) * keys[key + 1, 0]
    )
    return _unit(value) if rotates else value


def _shortest(first: Array, second: Array, t: float) -> Array:
    """The rotation by ``t`` of the turn from ``first`` to ``second``.

    As a turn about an axis, and not as a sum of sines: first times
    (first^-1 second)^t.
    """
    x, y, z, w = _times(_conjugate(first), second)
    if w < 0:
        x, y, z, w = -x, -y, -z, -w
    length = math.hypot(x, y, z)
    if length == 0:
        return first
    half = t * math.atan2(length, w)
    scale = math.sin(half) / length
    turn = np.array([x * scale, y * scale, z * scale, math.cos(half)])
    return _times(first, turn)


def _unit(quaternion: Array) -> Array:
    return np.asarray(quaternion / math.hypot(*quaternion))


def _conjugate(q: Array) -> Array:
    return np.array([-q[0], -q[1], -q[2], q[3]])


def _times(a: Array, b: Array) -> Array:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return np.array(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )
