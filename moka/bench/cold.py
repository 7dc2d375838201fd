"""Time of a render in a fresh process, stage by stage."""

import argparse
from typing import TYPE_CHECKING, Any

from moka.bench.options import add_scene_options
from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from moka.bench.processes import ProcessRun

__all__ = ["add_arguments", "execute"]

NOT_CACHED = "not cached"
CACHED = "cached"
AGAINST = "against"

MEASURES = ("wall_ms", "cpu_ms", "peak_rss_mb")

# What the installed command does. `python -m` looks for it: 4 ms more.
_COMMAND = "from moka.cli import main; main()"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench cold``."""
    add_scene_options(parser, (1024, 1024))
    add = parser.add_argument
    add(
        "--runs",
        metavar="N",
        type=count,
        default=7,
        help="processes of each kind, after one that is not counted "
        "(default: 7)",
    )
    add(
        "--against",
        metavar="COMMAND",
        help="another command line, run in turn with moka's; the base of "
        "the ratios",
    )
    add(
        "--cold-shader-cache",
        action="store_true",
        help="give every process an empty shader cache of Mesa",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print tables and write what was asked for."""
    import tempfile
    from pathlib import Path

    from moka.bench.processes import in_turn
    from moka.bench.results import check_output, write_json

    check_output(arguments.json, arguments.plot)
    stages: dict[str, list[dict[str, Any]]] = {NOT_CACHED: [], CACHED: []}
    with tempfile.TemporaryDirectory() as name:
        runs = in_turn(_jobs(arguments, Path(name), stages), arguments.runs)
    result = _result(arguments, runs, stages)
    _print(result)
    if arguments.json:
        write_json(result, arguments.json)
    if arguments.plot:
        from moka.bench.plot import plot_histogram

        plot_histogram(
            {
                kind: [run.wall_ms for run in each]
                for kind, each in runs.items()
            },
            arguments.plot,
        )
    return 0


def _jobs(
    arguments: argparse.Namespace,
    folder: "Path",
    stages: dict[str, list[dict[str, Any]]],
) -> "dict[str, Callable[[], ProcessRun]]":
    """What is run in turn; the statistics of moka's runs go to ``stages``.

    The cache of lighting is one of their own, full after the warm-up.
    """
    import json
    import shlex
    import sys

    from moka.bench.processes import run_process

    statistics = folder / "statistics.json"
    width, height = arguments.size
    render = [sys.executable, "-c", _COMMAND, "render"]
    render += [arguments.model] if arguments.model else []
    render += ["--size", f"{width}x{height}"]
    render += ["--environment", arguments.environment]
    render += ["--samples", str(arguments.samples)]
    render += ["--backend", arguments.backend, "-o", str(folder / "out.png")]
    render += ["--stats", str(statistics)]
    environment = {"MOKA_CACHE_DIR": str(folder / "cache")}

    def fresh() -> dict[str, str]:
        """The environment of one process."""
        if not arguments.cold_shader_cache:
            return environment
        import tempfile

        shaders = tempfile.mkdtemp(dir=folder)
        return {**environment, "MESA_SHADER_CACHE_DIR": shaders}

    def moka(kind: str, *options: str) -> "ProcessRun":
        run = run_process([*render, *options], fresh())
        stages[kind].append(json.loads(statistics.read_text()))
        return run

    jobs: dict[str, Callable[[], ProcessRun]] = {}
    if arguments.against:
        command = shlex.split(arguments.against)
        jobs[AGAINST] = lambda: run_process(command, fresh())
    jobs[NOT_CACHED] = lambda: moka(NOT_CACHED, "--no-cache")
    jobs[CACHED] = lambda: moka(CACHED)
    return jobs


def _result(
    arguments: argparse.Namespace,
    runs: "dict[str, list[ProcessRun]]",
    stages: dict[str, list[dict[str, Any]]],
) -> dict[str, Any]:
    """What the JSON file holds."""
    from moka.bench.measure import ratio_of_pairs, spread

    base = AGAINST if arguments.against else NOT_CACHED
    result: dict[str, Any] = {
        "gl": stages[CACHED][-1]["gl"],
        "command": arguments.against,
        "base": base,
        "kinds": {},
    }
    for kind, each in runs.items():
        entry: dict[str, Any] = {}
        for measure in MEASURES:
            values = [getattr(run, measure) for run in each]
            if None in values:
                continue
            entry[measure] = spread(values).as_dict()
            bases = [getattr(run, measure) for run in runs[base]]
            entry[measure] |= ratio_of_pairs(values, bases).as_dict()
        if kind in stages:
            # The first was the warm-up.
            counted = stages[kind][1:]
            entry["stages_ms"] = {
                stage: spread(
                    [run["stages_ms"].get(stage, 0.0) for run in counted]
                ).as_dict()
                for stage in counted[-1]["stages_ms"]
            }
            entry["counts"] = counted[-1]["counts"]
            entry["lighting"] = counted[-1]["lighting"]
        result["kinds"][kind] = entry
    return result


def _print(result: dict[str, Any]) -> None:
    """The result for a person: whole processes, then moka's stages."""
    from moka.bench.results import format_table

    rows = [
        [
            f"{kind}, {measure}",
            *(
                figures[name]
                for name in ("median", "quartile_1", "quartile_3", "minimum")
            ),
            f"{figures['ratio']:.2f}",
            f"{figures['low']:.2f} to {figures['high']:.2f}",
        ]
        for kind, entry in result["kinds"].items()
        for measure, figures in entry.items()
        if measure in MEASURES
    ]
    header = ["process", "median", "quartile 1", "quartile 3", "minimum"]
    print(format_table([*header, f"to {result['base']}", "95 %"], rows))
    kinds = {
        kind: entry["stages_ms"]
        for kind, entry in result["kinds"].items()
        if "stages_ms" in entry
    }
    names = dict.fromkeys(stage for each in kinds.values() for stage in each)
    print()
    print("Stages overlap where they run in several threads.")
    print(
        format_table(
            ["stage, median ms", *kinds],
            [
                [
                    name,
                    *(
                        each[name]["median"] if name in each else "-"
                        for each in kinds.values()
                    ),
                ]
                for name in names
            ],
        )
    )
