"""The results of a survey as a drawing, by Matplotlib."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from moka.core.errors import OptionError
from moka.survey.analysis import Analysis
from moka.survey.answers import HIGHEST, LOWEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from moka.survey.statistics import Summary

__all__ = ["plot"]

_SUFFIXES = (".png", ".svg", ".pdf")


def plot(found: Analysis, path: Path) -> None:
    """Draw the means of the renderers, and the differences of the pairs.

    Bars are 95 % intervals; the margin is a band around 0. Raises
    OptionError for another ending than .png, .svg and .pdf, if the file
    cannot be written, and where Matplotlib is missing.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise OptionError(
            f"{path}: a plot needs the ending {', '.join(_SUFFIXES)}"
        )
    try:
        # No window and no state of pyplot: a figure that is only saved.
        from matplotlib.figure import Figure
    except ImportError as error:
        raise OptionError(
            "a plot needs the package matplotlib: pip install 'moka-pbr[bench]'"
        ) from error
    rows = max(len(found.renderers), len(found.pairs), 2)
    figure = Figure(figsize=(10, 1.6 + 0.4 * rows), layout="constrained")
    left, right = figure.subplots(1, 2)

    _draw(
        left,
        [each.name for each in found.renderers],
        [each.ratings for each in found.renderers],
    )
    left.set_xlim(LOWEST, HIGHEST)
    left.set_xticks(range(LOWEST, HIGHEST + 1))
    left.set_xlabel("mean rating")
    left.set_title(f"{found.participants} participants, 95 % intervals")

    if found.criterion:
        margin = found.criterion.margin
        right.axvspan(-margin, margin, color="0.9", label=f"margin {margin:g}")
        right.legend(loc="best", frameon=False)
    right.axvline(0, color="0.5", linewidth=1)
    _draw(
        right,
        [f"{each.first} − {each.second}" for each in found.pairs],
        [each.difference for each in found.pairs],
    )
    right.set_xlabel("mean difference of ratings")
    right.set_title("differences, 95 % intervals")
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        raise OptionError(
            f"{path}: cannot write the plot: {error.strerror}"
        ) from error


def _draw(
    axes: Any, labels: "Sequence[str]", summaries: "Sequence[Summary]"
) -> None:
    """Means with intervals, the first at the top."""
    places = range(len(labels))
    for place, each in zip(places, summaries, strict=True):
        axes.plot([each.low, each.high], [place, place], color="C0")
    axes.plot(
        [each.mean for each in summaries],
        list(places),
        linestyle="",
        marker="o",
        color="C0",
    )
    axes.set_yticks(list(places), labels)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.spines[["top", "right"]].set_visible(False)
