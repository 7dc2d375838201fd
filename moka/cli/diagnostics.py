"""What every command can tell besides its result, and how it is asked to."""

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["add_diagnostics", "log_lines"]


def add_diagnostics(
    parser: argparse.ArgumentParser, *, nested: bool = False
) -> None:
    """Add --debug, --verbose and --quiet.

    A ``nested`` command has a parent that has them too, whose values stand
    where it is not given its own.
    """
    # Without a default, what the parent was given is not overwritten.
    absent: dict[str, Any] = {"default": argparse.SUPPRESS} if nested else {}
    parser.add_argument(
        "--debug",
        action="store_true",
        **absent,
        help="show the traceback of an error, and check every GL call",
    )
    volume = parser.add_mutually_exclusive_group()
    volume.add_argument(
        "-v",
        "--verbose",
        action="count",
        **(absent or {"default": 0}),
        help="say what is read, found and chosen; twice: in detail",
    )
    volume.add_argument(
        "-q",
        "--quiet",
        action="store_true",
        **absent,
        help="say nothing but errors",
    )


@contextmanager
def log_lines(*, verbose: int, quiet: bool) -> Iterator[None]:
    """Meanwhile what moka logs is lines on standard error.

    Warnings by default; information and debug messages as often as
    ``verbose``; nothing below an error if ``quiet``.
    """
    import logging

    class Line(logging.Formatter):
        def format(self, record: logging.LogRecord) -> str:
            text = " ".join(record.getMessage().split())
            return f"moka: {record.levelname.lower()}: {text}"

    levels = (logging.WARNING, logging.INFO, logging.DEBUG)
    logger = logging.getLogger("moka")
    level_before = logger.level
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(Line())
    logger.addHandler(handler)
    logger.setLevel(logging.ERROR if quiet else levels[min(verbose, 2)])
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level_before)
