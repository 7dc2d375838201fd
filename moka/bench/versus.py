"""Run two benchmarks in turn; print the ratios of medians."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["add_arguments", "execute", "medians"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench versus``."""
    add = parser.add_argument
    add(
        "base",
        metavar="A",
        help="arguments of moka bench in one string, such as "
        "'frame model.glb --samples 4'",
    )
    add(
        "other",
        metavar="B",
        nargs="?",
        help="other arguments (default: the same, for --checkout)",
    )
    add(
        "--checkout",
        metavar="FOLDER",
        type=Path,
        help="a folder that holds another moka, which runs B",
    )
    add(
        "--rounds",
        metavar="N",
        type=count,
        default=7,
        help="runs of each, in turn (default: 7)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print a table and write what was asked for."""
    from moka.bench.measure import ratio_of_pairs, spread
    from moka.bench.results import check_output, format_table, write_json
    from moka.core.errors import OptionError

    check_output(arguments.json, arguments.plot)
    if arguments.plot:
        raise OptionError("--plot: versus draws nothing; use --json")
    if arguments.other is None and arguments.checkout is None:
        raise OptionError("versus: needs B or --checkout, or both")
    if arguments.checkout and not (arguments.checkout / "moka").is_dir():
        raise OptionError(f"{arguments.checkout}: holds no folder moka")
    base, other = _rounds(arguments)
    common = [name for name in base[0] if name in other[0]]
    result = {}
    for name in common:
        series = [[each[name] for each in side] for side in (base, other)]
        result[name] = {
            "a": spread(series[0]).median,
            "b": spread(series[1]).median,
            **ratio_of_pairs(series[1], series[0]).as_dict(),
        }
    print(
        format_table(
            ["median", "A", "B", "B / A", "95 %"],
            [
                [
                    name,
                    found["a"],
                    found["b"],
                    f"{found['ratio']:.3f}",
                    f"{found['low']:.3f} to {found['high']:.3f}",
                ]
                for name, found in result.items()
            ],
        )
    )
    if arguments.json:
        write_json(
            {
                "a": arguments.base,
                "b": arguments.other or arguments.base,
                "checkout": arguments.checkout and str(arguments.checkout),
                "rounds": arguments.rounds,
                "medians": result,
            },
            arguments.json,
        )
    return 0


def _rounds(
    arguments: argparse.Namespace,
) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
    """The medians that each round of A and of B found."""
    import json
    import shlex
    import sys
    import tempfile

    from moka.bench.processes import run_process

    sides: tuple[list[dict[str, float]], list[dict[str, float]]] = ([], [])
    texts = arguments.base, arguments.other or arguments.base
    ours = Path(__file__).resolve().parents[2]
    folders = ours, (arguments.checkout or ours).resolve()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "result.json")
        for number in range(arguments.rounds):
            # A B, B A: what one leaves behind is not always the other's.
            for side in (0, 1) if number % 2 == 0 else (1, 0):
                run_process(
                    [
                        # -P: not what happens to lie in this folder.
                        *(sys.executable, "-P", "-m", "moka", "bench"),
                        *shlex.split(texts[side]),
                        *("--json", str(path)),
                    ],
                    {"PYTHONPATH": str(folders[side])},
                )
                found = dict(medians(json.loads(path.read_text())))
                sides[side].append(found)
    return sides


def medians(result: Any, path: str = "") -> "Iterator[tuple[str, float]]":
    """Where a benchmark's result holds positive medians, and which."""
    if isinstance(result, list):
        result = {str(index): value for index, value in enumerate(result)}
    if not isinstance(result, dict):
        return
    for name, value in result.items():
        where = f"{path}.{name}" if path else name
        if name.endswith("median"):
            if isinstance(value, int | float) and value > 0:
                yield where.removesuffix(".median"), float(value)
        else:
            yield from medians(value, where)
