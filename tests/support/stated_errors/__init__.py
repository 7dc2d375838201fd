"""The largest error of each term: what docs/theory states.

A measure evaluates a GLSL function over a dense grid and compares it with the
float64 oracle of its formula, at the same float32 inputs. Run as a program,
``python -m tests.support.stated_errors``, it prints what the tables of
docs/theory hold; tests/gpu/test_stated_errors.py keeps them true.
"""

from collections.abc import Callable

from tests.support.stated_errors import colour, environment, reflection

__all__ = ["MEASURES"]

#: What the tables call it, and how it is measured.
MEASURES: dict[str, Callable[[], float]] = {
    **reflection.MEASURES,
    **environment.MEASURES,
    **colour.MEASURES,
}
