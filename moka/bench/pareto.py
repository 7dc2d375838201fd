"""Which of several choices are worth having: the Pareto front."""

from collections.abc import Sequence

__all__ = ["pareto_front"]

# Times are never exactly equal, errors nearly are where a knob does nothing.
_SAME_COST = 1.05
_SAME_ERROR = 1.001


def pareto_front(points: Sequence[tuple[float, float]]) -> list[bool]:
    """For each of (cost, error), whether nothing else is plainly better.

    Costs within 5 % and errors within 0.1 % count as equal. Better is what
    has less of one and not more of the other.
    """
    return [
        not any(_beats(other, point) for other in points) for point in points
    ]


def _beats(one: tuple[float, float], other: tuple[float, float]) -> bool:
    cheaper = one[0] * _SAME_COST < other[0]
    no_dearer = one[0] <= other[0] * _SAME_COST
    closer = one[1] * _SAME_ERROR < other[1]
    no_farther = one[1] <= other[1] * _SAME_ERROR
    return (cheaper and no_farther) or (closer and no_dearer)
