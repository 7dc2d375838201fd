"""What the texts of command-line options mean, for argparse's ``type``."""

import argparse
import math

__all__ = ["LARGEST_SIDE", "count", "name_or_index", "number", "size"]

#: Pixels along a side of a picture; what drivers of GL 4 can draw into.
LARGEST_SIDE = 16384


def size(text: str) -> tuple[int, int]:
    """Width and height in pixels of a text such as 1280x720."""
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not WIDTHxHEIGHT, such as 1280x720"
        )
    sides = int(width), int(height)
    if not all(1 <= side <= LARGEST_SIDE for side in sides):
        raise argparse.ArgumentTypeError(
            f"{text!r}: each side must be from 1 to {LARGEST_SIDE}"
        )
    return sides


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def count(text: str) -> int:
    """A whole number of at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not 1, 2, 3, ...")
    return int(text)


def name_or_index(text: str) -> str | int:
    """The number that a text is, else the text as a name."""
    return int(text) if text.isdecimal() else text
