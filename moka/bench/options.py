"""Options that several benchmarks share, and what their texts mean."""

import argparse

from moka.core.option_text import count, size

__all__ = [
    "add_backend_option",
    "add_scene_options",
    "counts",
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


def counts(text: str) -> tuple[int, ...]:
    """Whole numbers of at least 1, separated by commas."""
    return tuple(count(part) for part in text.split(","))
