"""The Pareto front, with the tolerance that measurements need."""

from hypothesis import given
from hypothesis import strategies as st

from moka.bench.pareto import pareto_front

numbers = st.floats(1e-3, 1e3)
points = st.lists(st.tuples(numbers, numbers), min_size=1, max_size=12)


def test_what_is_worse_in_both_is_off_the_front() -> None:
    assert pareto_front([(1, 9), (5, 5), (6, 6), (9, 1)]) == [
        True,
        True,
        False,
        True,
    ]


def test_nearly_equal_costs_let_the_error_decide() -> None:
    assert pareto_front([(1.0, 9), (1.04, 5)]) == [False, True]
    assert pareto_front([(1.0, 9), (1.06, 5)]) == [True, True]


def test_nearly_equal_errors_let_the_cost_decide() -> None:
    assert pareto_front([(1.0, 5.0), (2.0, 4.999)]) == [True, False]
    assert pareto_front([(1.0, 5.0), (1.01, 5.0)]) == [True, True]


@given(points)
def test_there_is_always_a_front_and_it_is_not_beaten(
    points: list[tuple[float, float]],
) -> None:
    front = pareto_front(points)
    assert any(front)
    for on_front, (cost, error) in zip(front, points, strict=True):
        if on_front:
            assert not any(
                other[0] * 1.05 < cost and other[1] * 1.001 < error
                for other in points
            )


@given(points)
def test_a_plainly_smallest_error_is_on_the_front(
    points: list[tuple[float, float]],
) -> None:
    least = min(error for _, error in points)
    assert pareto_front([*points, (1e4, least / 2)])[-1]
