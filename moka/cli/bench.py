"""Measure moka: errors against truth, times, work done."""

import argparse
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from moka.cli.diagnostics import add_diagnostics

__all__ = ["add_arguments", "execute"]

# Each is a module of moka.bench with add_arguments and execute, which imports
# what is heavy where it is used: all of them are imported for their options.
_BENCHMARKS = {
    "accuracy": "Error of every mode of lighting against time.",
    "cold": "Time of a render in a fresh process, stage by stage.",
    "frame": "Time of a frame of a steady orbit around a model.",
    "scale": "Growth of a frame's time with objects, lights, pixels and more.",
    "lighting": "Time to preintegrate environments, or to find them cached.",
    "commands": "Time to record, sort and merge draws, without a GPU.",
    "versus": "Run two benchmarks in turn; print the ratios of medians.",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add a subcommand for each benchmark.

    All of them have ``--json`` and ``--plot``; the benchmark's own options
    come from its ``add_arguments(parser)``, its results and the exit code
    from its ``execute(arguments)``.
    """
    commands = parser.add_subparsers(
        title="benchmarks", metavar="NAME", required=True
    )
    for name, summary in _BENCHMARKS.items():
        command = commands.add_parser(
            name, help=summary, description=summary, allow_abbrev=False
        )
        add = command.add_argument
        add_diagnostics(command, nested=True)
        add("--json", metavar="PATH", type=Path, help="write the results")
        add(
            "--plot",
            metavar="PATH",
            type=Path,
            help="draw the results, as .png, .svg or .pdf",
        )
        module = import_module(f"moka.bench.{name}")
        module.add_arguments(command)
        command.set_defaults(run=module.execute)


def execute(arguments: argparse.Namespace) -> int:
    """Run the chosen benchmark; raises MokaError."""
    run: Callable[[argparse.Namespace], int] = arguments.run
    return run(arguments)
