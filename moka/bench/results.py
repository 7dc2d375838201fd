"""Where results go: a JSON file, a table, a plot."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from moka.core.atomic_file import atomic_file
from moka.core.errors import OptionError

__all__ = ["check_output", "format_table", "write_json"]

PLOT_SUFFIXES = (".png", ".svg", ".pdf")


def check_output(json_path: Path | None, plot_path: Path | None) -> None:
    """Raise OptionError before the work for what could not be written."""
    for path in (json_path, plot_path):
        if path is not None and not path.parent.is_dir():
            raise OptionError(f"{path}: the folder {path.parent} is missing")
    if plot_path and plot_path.suffix.lower() not in PLOT_SUFFIXES:
        raise OptionError(
            f"{plot_path}: a plot needs the ending {', '.join(PLOT_SUFFIXES)}"
        )


def write_json(result: dict[str, Any], path: Path) -> None:
    """Write ``result``; raises OptionError if it cannot."""
    text = json.dumps(result, indent=2) + "\n"
    try:
        with atomic_file(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OptionError(f"{path}: cannot write: {error.strerror}") from error


def format_table(
    header: Sequence[str], rows: Sequence[Sequence[object]]
) -> str:
    """Lines of a table: the first column left, the others right.

    Floats have three significant digits, or all before the point.
    """
    cells = [[_cell(value) for value in row] for row in (header, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join(
        "  ".join(
            text.ljust(width) if index == 0 else text.rjust(width)
            for index, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cells
    )


def _cell(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
