"""Time to record, sort and merge draws, without a GPU."""

import argparse
from typing import TYPE_CHECKING, Any

from moka.bench.options import counts
from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["add_arguments", "execute"]

STEPS = ("by_hand_ms", "record_ms", "sort_ms", "merge_ms", "submit_ms")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench commands``."""
    add = parser.add_argument
    add(
        "--draws",
        metavar="N,...",
        type=counts,
        default=(10, 100, 1_000, 10_000, 100_000),
        help="how many a frame has (default: 10,100,1000,10000,100000)",
    )
    add(
        "--runs",
        metavar="N",
        type=count,
        default=15,
        help="of each, after one that is not counted (default: 15)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print a table and write what was asked for."""
    from moka.bench.measure import growth_exponent
    from moka.bench.results import check_output, write_json

    check_output(arguments.json, arguments.plot)
    points = [_point(number, arguments.runs) for number in arguments.draws]
    exponents = {
        step: round(
            growth_exponent(
                [point["draws"] for point in points if step in point],
                [point[step]["median"] for point in points if step in point],
            ),
            3,
        )
        for step in STEPS
        if sum(step in point for point in points) > 1
    }
    result = {"exponents": exponents, "points": points}
    _print(result)
    if arguments.json:
        write_json(result, arguments.json)
    if arguments.plot:
        _plot(arguments, points)
    return 0


def _point(number: int, runs: int) -> dict[str, Any]:
    """Times of ``number`` draws of 8 programs, 64 materials, 32 meshes.

    ``by_hand_ms`` records them one by one, ``record_ms`` as one array,
    ``sort_ms`` brings the array in order, ``merge_ms`` makes batches of it
    on the other thread, ``submit_ms`` is all three of them from the call
    until a device without a GPU is done.
    """
    from moka.bench.draw_work import MOST_BY_HAND, DrawWork
    from moka.bench.measure import milliseconds_in_turn

    with DrawWork(number) as work:
        jobs: dict[str, Callable[[], None]] = {
            "record_ms": work.record,
            "sort_ms": work.sort,
            "merge_ms": work.merge,
            "submit_ms": work.submit,
        }
        if number <= MOST_BY_HAND:
            jobs["by_hand_ms"] = work.record_by_hand
        times = milliseconds_in_turn(jobs, runs)
        return {"draws": number, **times, "counts": work.counts}


def _print(result: dict[str, Any]) -> None:
    from moka.bench.results import format_table

    rows = [
        [
            str(point["draws"]),
            *(
                point[step]["median"] if step in point else "-"
                for step in STEPS
            ),
            point["counts"]["commands"],
            point["counts"]["gl_draws"],
        ]
        for point in result["points"]
    ]
    steps = [step.removesuffix("_ms").replace("_", " ") for step in STEPS]
    print(
        format_table(
            ["draws, median ms", *steps, "GL commands", "GL draws"], rows
        )
    )
    for step, exponent in result["exponents"].items():
        name = step.removesuffix("_ms").replace("_", " ")
        print(f"{name}: time grows as draws to the power of {exponent:.2f}")


def _plot(arguments: argparse.Namespace, points: list[dict[str, Any]]) -> None:
    from moka.bench.plot import plot_growth

    plot_growth(
        {
            step.removesuffix("_ms").replace("_", " "): [
                (
                    point["draws"],
                    point[step]["median"],
                    point[step]["quartile_1"],
                    point[step]["quartile_3"],
                )
                for point in points
                if step in point
            ]
            for step in STEPS
        },
        "draws in a frame",
        arguments.plot,
    )
