"""Parses the command line and turns errors into one line each."""

import argparse
import gc
import os
import sys
import time
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from typing import Any, NoReturn

from moka.cli.diagnostics import add_diagnostics, log_lines
from moka.cli.process import INTERRUPTED, run_process
from moka.core.errors import MokaError, OptionError
from moka.version import __version__

__all__ = ["full_parser", "main"]

# Where the clock of a run starts: before anything heavy is imported.
STARTED = time.perf_counter()

# Each is a module of this package, and its docstring's first line.
_COMMANDS = {
    "render": "Render one picture of a glTF model, or of the built-in scene.",
    "view": "Open a model in a window, to turn it around and to look into it.",
    "info": "Say what a glTF file holds, and what of it a picture needs.",
    "validate": "Check a glTF file against the rules of the specification.",
    "compare": "Compare a picture with a reference: FLIP, PSNR and RMSE.",
    "survey": "Make a blind survey of pictures, and analyse its answers.",
    "bench": "Measure moka: errors against truth, times, work done.",
    "cache": "Say what the cache of preintegrated lighting holds, or clear it.",
    "completion": "Print a script that completes commands, options and files "
    "in a shell.",
    "doctor": "Say which OpenGL contexts work here and what is missing.",
}

# New objects before Python looks for cycles, 700 otherwise. Those of imports
# live until the end, so that looking there is for nothing.
_OBJECTS_OF_A_PICTURE = 100_000

USER_ERROR = 2
INTERNAL_ERROR = 1


class _Parser(argparse.ArgumentParser):
    """Raises OptionError where argparse would print usage and exit."""

    def __init__(self, **options: Any) -> None:
        # argparse makes a formatter for every option that is added, and each
        # would ask the terminal for its width: 2 ms, most of them an import.
        super().__init__(
            formatter_class=partial(argparse.HelpFormatter, width=80),
            **options,
        )

    def format_help(self) -> str:
        """The help, as wide as the terminal."""
        self.formatter_class = argparse.HelpFormatter
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        raise OptionError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    ``arguments`` are those after the program's name. Without them they are
    those of the process, which then is ours and ends: :func:`run_process`.
    """
    if arguments is None:
        given = sys.argv[1:]
        if given[:1] == ["render"]:
            gc.set_threshold(_OBJECTS_OF_A_PICTURE)
        run_process(partial(_run, given, owns_process=True))
    return _run(list(arguments))


def _run(given: Sequence[str], *, owns_process: bool = False) -> int:
    # NumPy's linear algebra starts a thread per core when it is loaded and
    # has only small matrices here: 40 ms of a processor for nothing.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    debug = "--debug" in given
    try:
        parsed = _parser(given).parse_args(given)
        parsed.started = STARTED
        parsed.owns_process = owns_process
        with log_lines(verbose=parsed.verbose, quiet=parsed.quiet):
            return int(parsed.execute(parsed))
    except MokaError as error:
        return _fail(str(error), USER_ERROR, debug=debug)
    except KeyboardInterrupt:
        return _fail("interrupted", INTERRUPTED, debug=debug)
    except BrokenPipeError:
        # Whoever read our output has gone; that is not an error.
        return 0
    except Exception as error:
        kind = type(error).__name__
        return _fail(
            f"internal error: {kind}: {error}; run again with --debug and "
            "report the traceback",
            INTERNAL_ERROR,
            debug=debug,
        )


def _parser(given: Sequence[str]) -> argparse.ArgumentParser:
    parser = _Parser(
        prog="moka",
        description="Render glTF scenes with physically based shading.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "--version", action="version", version=f"moka {__version__}"
    )
    commands = parser.add_subparsers(
        # It would be found with a formatter, which looks for a terminal.
        title="commands",
        metavar="COMMAND",
        required=True,
        prog=parser.prog,
    )
    is_named = given[:1] and given[0] in _COMMANDS
    for name, summary in _COMMANDS.items():
        if is_named and name not in given:
            continue  # Nobody will read about it.
        command = commands.add_parser(
            name, help=summary, description=summary, allow_abbrev=False
        )
        add_diagnostics(command)
        if name in given:
            # The others are not needed, nor what they import.
            module = import_module(f"moka.cli.{name}")
            module.add_arguments(command)
            command.set_defaults(execute=module.execute)
    return parser


def full_parser() -> argparse.ArgumentParser:
    """The parser with the options of every command."""
    return _parser(tuple(_COMMANDS))


def _fail(message: str, code: int, *, debug: bool) -> int:
    if debug:
        import traceback

        traceback.print_exc()
    line = " ".join(message.split())
    print(f"moka: error: {line}", file=sys.stderr)
    return code
