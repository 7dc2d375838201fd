"""Options that several benchmarks share, and what their texts mean."""

import argparse
import math

__all__ = [
    "add_backend_option",
    "add_scene_options",
    "count",
    "counts",
    "number",
    "size",
]


def add_scene_options(
    parser: argparse.ArgumentParser, default_size: tuple[int, int]
) -> None:
    """Add what to draw: MODEL, --size, --environment, --samples, --backend."""
    add = parser.add_argument
    add(
        "model",
        metavar="MODEL",
        nargs="?",
        help=".gltf or .glb file (default: the built-in demo scene)",
    )
    add(
        "--size",
        metavar="WxH",
        type=size,
        default=default_size,
        help="pixels (default: {}x{})".format(*default_size),
    )
    add(
        "--environment",
        metavar="PATH|NAME",
        default="studio",
        help=".hdr or .exr equirectangular map, or studio, sky, furnace, "
        "none (default: studio)",
    )
    add(
        "--samples",
        metavar="N",
        type=count,
        default=4,
        help="multisampling, 1 = off (default: 4)",
    )
    add_backend_option(parser)


def add_backend_option(parser: argparse.ArgumentParser) -> None:
    """Add --backend."""
    parser.add_argument(
        "--backend",
        choices=("auto", "egl", "osmesa", "window"),
        default="auto",
        help="GL context (default: auto)",
    )


def size(text: str) -> tuple[int, int]:
    """Width and height of a text such as 1024x1024."""
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal()) or not (
        1 <= int(width) <= 16384 and 1 <= int(height) <= 16384
    ):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not WIDTHxHEIGHT, such as 1024x1024"
        )
    return int(width), int(height)


def count(text: str) -> int:
    """A whole number of at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not 1, 2, 3, ...")
    return int(text)


def counts(text: str) -> tuple[int, ...]:
    """Whole numbers of at least 1, separated by commas."""
    return tuple(count(part) for part in text.split(","))


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value
