"""An analysis as text, as JSON and its ratings as a table."""

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from moka.core.atomic_file import atomic_file
from moka.core.errors import OptionError
from moka.survey.analysis import Analysis, Criterion
from moka.survey.answers import Answers

__all__ = ["as_json", "as_text", "write_csv"]

_SMALLEST_P = 0.001


def as_text(found: Analysis) -> str:
    """The results for a person, without a newline at the end."""
    lines = [_counts(found), ""]
    lines += _table(
        ["renderer", "mean", "95 % interval", "deviation", "mean rank"],
        [
            [
                each.name,
                f"{each.ratings.mean:.2f}",
                _range(each.ratings.low, each.ratings.high),
                _number(each.ratings.deviation),
                f"{each.rank:.2f}",
            ]
            for each in found.renderers
        ],
    )
    lines.append("")
    lines += _table(
        ["pair", "difference", "95 % interval", "t-test", "Holm", "Wilcoxon"],
        [
            [
                f"{each.first} - {each.second}",
                f"{each.difference.mean:+.2f}",
                _range(each.difference.low, each.difference.high),
                *(
                    _probability(p)
                    for p in (each.p_t, each.p_holm, each.p_wilcoxon)
                ),
            ]
            for each in found.pairs
        ],
    )
    if found.criterion:
        lines += ["", *_verdict(found.criterion)]
    return "\n".join(lines)


def as_json(found: Analysis) -> str:
    """The results as JSON; what is not known is null."""
    data = asdict(found)
    if found.criterion:
        data["criterion"]["met"] = found.criterion.met
    return json.dumps(_without_nan(data), indent=2, ensure_ascii=False)


def write_csv(answers: Answers, path: Path) -> None:
    """Write one row per rating; raises OptionError if that fails.

    Participants and positions count from 1; the position is that among all
    pictures that the person was shown, sets count in the order of the key.
    """
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["participant", "position", "set", "scene", "renderer", "rating"]
    )
    for each in answers.ratings:
        rows.writerow(
            [
                each.participant + 1,
                each.position + 1,
                each.set + 1,
                each.scene,
                each.renderer,
                each.rating,
            ]
        )
    try:
        with atomic_file(path) as temporary:
            temporary.write_text(text.getvalue(), "utf-8")
    except OSError as error:
        raise OptionError(
            f"{path}: cannot write the table: {error.strerror}"
        ) from error


def _counts(found: Analysis) -> str:
    people = "participant" if found.participants == 1 else "participants"
    scenes = "scene" if found.scenes == 1 else "scenes"
    text = f"{found.participants} {people}, {found.scenes} {scenes}"
    if found.repeated:
        files = "file" if found.repeated == 1 else "files"
        text += f" ({found.repeated} {files} given twice, counted once)"
    return text


def _verdict(criterion: Criterion) -> list[str]:
    lines = [
        f"{criterion.candidate} - {each.engine}: "
        f"{each.difference.mean:+.2f}, 90 % interval "
        f"{_range(each.difference.least, each.difference.most)}: "
        f"{each.verdict}"
        for each in criterion.verdicts
    ]
    engines = ", ".join(each.engine for each in criterion.verdicts)
    answer = "yes" if criterion.met else "not shown"
    return [
        *lines,
        f"rated like {engines} with a margin of {criterion.margin:g}: {answer}",
    ]


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Columns of equal width, the first to the left, the others right."""
    widths = [
        max(map(len, column)) for column in zip(header, *rows, strict=True)
    ]
    return [
        "  ".join(
            cell.rjust(width) if index else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in (header, *rows)
    ]


def _range(low: float, high: float) -> str:
    return "-" if math.isnan(low) else f"{low:.2f} to {high:.2f}"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _probability(value: float) -> str:
    if math.isnan(value):
        return "-"
    return "<0.001" if value < _SMALLEST_P else f"{value:.3f}"


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _without_nan(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(each) for each in value]
    if isinstance(value, float) and math.isnan(value):
        return None
    return value
