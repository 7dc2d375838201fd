"""The chart of error against time, by Matplotlib."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from moka.bench.accuracy_results import Point, UnderEnvironment, mean_points
from moka.bench.plot import new_figure, save_figure

__all__ = ["plot_accuracy"]

_MARKERS = {"split-sum": "o", "filtered": "s", "reference": "^"}
# Points from a ring to its name; two of the rings nearly meet.
_BESIDE = {"fast": (-30, -3), "balanced": (-12, -17), "best": (-8, -17)}
_INCHES = (9.0, 6.75)


def plot_accuracy(results: Sequence[UnderEnvironment], path: Path) -> None:
    """Draw means over environments: two errors against two times.

    The line is the Pareto front, rings are the named qualities. Raises
    OptionError where Matplotlib is missing or the file cannot be written.
    """
    points = mean_points(results)
    figure = new_figure(_INCHES)
    rows = figure.subplots(2, 2, sharex="col", sharey="row")
    for row, error, label in zip(
        rows,
        ("relative_rmse", "median"),
        ("mean relative RMSE of a sphere", "median relative error of a pixel"),
        strict=True,
    ):
        for axes, time in zip(row, ("picture_ms", "first_ms"), strict=True):
            _draw(axes, points, time, error)
        row[0].set_ylabel(label)
    rows[1][0].set_xlabel("a picture, ms")
    rows[1][1].set_xlabel("preintegration and the first picture, ms")
    rows[0][0].legend(loc="best", frameon=False, fontsize="small")
    names = ", ".join(result.title for result in results)
    figure.suptitle(f"Error and time, means over {names}", fontsize="medium")
    save_figure(figure, path)


def _draw(axes: Any, points: list[Point], time: str, error: str) -> None:
    for index, (family, marker) in enumerate(_MARKERS.items()):
        of_family = [each for each in points if each.mode.family == family]
        axes.plot(
            [getattr(each, time) for each in of_family],
            [getattr(each, error) for each in of_family],
            linestyle="",
            marker=marker,
            color=f"C{index}",
            label=family,
        )
    if error == "relative_rmse":
        _draw_front(axes, points, time)
    for each in points:
        place = getattr(each, time), getattr(each, error)
        _write(axes, each.mode.label, place, (5, 4))
        if each.mode.quality:
            quality = each.mode.quality
            _write(axes, quality, place, _BESIDE[quality], weight="bold")
            axes.plot(
                *place,
                marker="o",
                markersize=13,
                markerfacecolor="none",
                markeredgecolor="black",
                linestyle="",
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.12)
    axes.grid(which="major", color="0.9")
    axes.spines[["top", "right"]].set_visible(False)


def _draw_front(axes: Any, points: list[Point], time: str) -> None:
    front = sorted(
        (getattr(each, time), each.relative_rmse)
        for each in points
        if (each.picture_front if time == "picture_ms" else each.first_front)
    )
    axes.plot(
        *zip(*front, strict=True),
        color="0.7",
        linewidth=1,
        zorder=0,
        label="Pareto front",
    )


def _write(
    axes: Any,
    text: str,
    place: tuple[float, float],
    offset: tuple[float, float],
    **style: str,
) -> None:
    axes.annotate(
        text,
        place,
        xytext=offset,
        textcoords="offset points",
        fontsize="x-small",
        **style,
    )
