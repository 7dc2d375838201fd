"""Single values: what users pass in, checked, as PyGLM's double precision.

Sequences and PyGLM values of either precision are accepted alike. PyGLM is
imported by the first value, since a plain render needs none.
"""

import math
from functools import cache
from typing import Any

import numpy as np

from moka.core.errors import OptionError
from moka.core.maths import Array

__all__ = [
    "pyglm",
    "to_matrix3",
    "to_quaternion",
    "to_stretch",
    "to_turn",
    "to_vector",
]


@cache
def pyglm() -> Any:
    """The module ``pyglm.glm``."""
    from pyglm import glm

    return glm


def _numbers(value: Any, count: int, what: str) -> list[float]:
    """``value`` as ``count`` finite floats, or an OptionError that says so."""
    try:
        numbers = [float(number) for number in value]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise OptionError(
            f"transform: {what} needs {count} finite numbers, "
            f"got {' '.join(str(value).split())}"
        )
    return numbers


def to_vector(value: Any, what: str) -> Any:
    """A dvec3 from three finite numbers; ``what`` names them in errors."""
    # One by one: PyGLM reads the numbers of a tuple in single precision.
    return pyglm().dvec3(*_numbers(value, 3, what))


def to_quaternion(value: Any) -> Any:
    """A unit dquat from PyGLM's quaternion or from (x, y, z, w)."""
    if hasattr(value, "w"):  # PyGLM iterates over w first.
        value = (value.x, value.y, value.z, value.w)
    x, y, z, w = _numbers(value, 4, "the rotation")
    length = math.hypot(x, y, z, w)
    if length == 0:
        raise OptionError("transform: the rotation must not be zero")
    return pyglm().dquat(w / length, x / length, y / length, z / length)


def to_stretch(value: Any) -> Any:
    """A diagonal dmat3 from three factors or one."""
    if isinstance(value, int | float | np.number):
        value = (value, value, value)
    return to_matrix3(np.diag(_numbers(value, 3, "the scale")))


def to_turn(axis: Any, angle: float) -> Any:
    """The dquat that turns by ``angle`` radians about ``axis``."""
    direction = to_vector(axis, "an axis")
    (radians,) = _numbers((angle,), 1, "an angle")
    length = math.hypot(*direction)
    if length == 0:
        raise OptionError("transform: an axis must not be zero")
    return pyglm().angleAxis(radians, direction / length)


def to_matrix3(matrix: Array) -> Any:
    """A dmat3 from an array (3, 3), [row, column]."""
    return pyglm().dmat3(*matrix.T.ravel().tolist())
