"""Plots of benchmarks, by Matplotlib."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from moka.core.errors import OptionError

__all__ = ["new_figure", "plot_growth", "plot_histogram", "save_figure"]

_DPI = 100


def plot_histogram(series: Mapping[str, ArrayLike], path: Path) -> None:
    """Draw the distribution of each series of milliseconds.

    Raises OptionError if Matplotlib is missing or the file cannot be
    written.
    """
    figure = new_figure((7, 2.2 * len(series)))
    axes = figure.subplots(len(series), 1, squeeze=False)[:, 0]
    for axis, (name, values) in zip(axes, series.items(), strict=True):
        axis.hist(values, bins="auto", color="0.4")
        axis.set_ylabel(name)
    axes[-1].set_xlabel("ms")
    save_figure(figure, path)


def plot_growth(
    curves: Mapping[str, Sequence[tuple[float, float, float, float]]],
    x_label: str,
    path: Path,
) -> None:
    """Draw points (x, median, low, high) of each curve, all logarithmic.

    Raises OptionError as :func:`plot_histogram` does.
    """
    figure = new_figure((7, 4.5))
    axis = figure.subplots()
    for name, points in curves.items():
        x, middle, low, high = (
            list(each) for each in zip(*points, strict=True)
        )
        axis.plot(x, middle, marker="o", markersize=3, label=name)
        axis.fill_between(x, low, high, alpha=0.2)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(x_label)
    axis.set_ylabel("ms, median and quartiles")
    axis.legend(frameon=False)
    axis.grid(which="major", color="0.9")
    save_figure(figure, path)


def new_figure(size: tuple[float, float]) -> Any:
    """A Matplotlib figure of ``size`` inches.

    Raises OptionError where Matplotlib is missing.
    """
    try:
        # No window and no state of pyplot: a figure that is only saved.
        from matplotlib.figure import Figure
    except ImportError as error:
        raise OptionError(
            "a plot needs the package matplotlib: pip install 'moka-pbr[bench]'"
        ) from error
    return Figure(figsize=size, layout="constrained")


def save_figure(figure: Any, path: Path) -> None:
    """Write it; raises OptionError where that cannot be."""
    try:
        figure.savefig(path, dpi=_DPI)
    except OSError as error:
        raise OptionError(f"{path}: cannot write: {error.strerror}") from error
