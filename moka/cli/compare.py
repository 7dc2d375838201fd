"""Compare a picture with a reference: FLIP, PSNR and RMSE."""

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING

from moka.core.errors import OptionError

if TYPE_CHECKING:
    from moka.bench.compare import Comparison

__all__ = ["add_arguments", "execute"]

EXCEEDED = 1
DEFAULT_METRICS = ("flip", "psnr", "rmse")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka compare``."""
    add = parser.add_argument
    add("reference", metavar="A", type=Path, help=".png, .jpg or .exr file")
    add(
        "test",
        metavar="B",
        type=Path,
        help="the picture to compare with A; an EXR file is compared as "
        "radiance with another, and tone mapped for the other kinds",
    )
    add(
        "--metric",
        metavar="NAME,...",
        type=lambda text: tuple(text.split(",")),
        default=DEFAULT_METRICS,
        help="flip, psnr, rmse, rel-rmse (default: flip,psnr,rmse)",
    )
    add(
        "--diff",
        metavar="PATH",
        type=Path,
        help="write a picture of the difference, .png or .exr: FLIP's "
        "errors if that is a metric, else the absolute difference",
    )
    add(
        "--max",
        metavar="METRIC=VALUE",
        type=_limit,
        action="append",
        default=[],
        help="exit with 1 if METRIC is larger, repeatable",
    )
    add(
        "--min",
        metavar="METRIC=VALUE",
        type=_limit,
        action="append",
        default=[],
        help="exit with 1 if METRIC is smaller (for psnr), repeatable",
    )
    add(
        "--tone-map",
        metavar="NAME",
        default="neutral",
        help="for an EXR file compared with another kind (default: neutral)",
    )
    add(
        "--exposure",
        metavar="EV",
        type=float,
        default=0.0,
        help="stops, for an EXR file compared with another kind (default: 0)",
    )
    add("--json", action="store_true", help="print JSON instead of text")


def execute(arguments: argparse.Namespace) -> int:
    """Print one line per metric; 1 if a limit is broken, else 0."""
    _check(arguments)
    from moka.bench.compare import compare_files

    comparison = compare_files(
        arguments.reference,
        arguments.test,
        arguments.metric,
        tone_map=arguments.tone_map,
        exposure=arguments.exposure,
    )
    values = comparison.values
    faults = {
        name: f"above {limit:g}"
        for name, limit in arguments.max
        if not values[name] <= limit
    }
    faults |= {
        name: f"below {limit:g}"
        for name, limit in arguments.min
        if not values[name] >= limit
    }
    if arguments.diff:
        comparison.save_difference(arguments.diff)
    if arguments.json:
        _print_json(arguments, comparison, faults)
    else:
        for name, value in values.items():
            unit = " dB" if name == "psnr" else ""
            fault = f"  {faults[name]}" if name in faults else ""
            print(f"{name:8} {value:.6g}{unit}{fault}")
    return EXCEEDED if faults else 0


def _check(arguments: argparse.Namespace) -> None:
    """Find mistakes in the options before the pictures are read."""
    for option in ("max", "min"):
        for name, _ in getattr(arguments, option):
            if name not in arguments.metric:
                raise OptionError(
                    f"--{option} {name}: is not among the metrics "
                    f"{','.join(arguments.metric)}"
                )
            if (name == "psnr") != (option == "min"):
                other = "--min" if option == "max" else "--max"
                better = "larger" if name == "psnr" else "smaller"
                raise OptionError(
                    f"--{option} {name}: {better} is better, use {other}"
                )
    path = arguments.diff
    if path and path.suffix.lower() not in (".png", ".exr"):
        raise OptionError(f"{path}: --diff needs the ending .png or .exr")
    if not math.isfinite(arguments.exposure):
        raise OptionError("--exposure: must be finite")


def _print_json(
    arguments: argparse.Namespace,
    comparison: "Comparison",
    faults: dict[str, str],
) -> None:
    import json

    height, width = comparison.difference.shape[:2]
    result = {
        "a": str(arguments.reference),
        "b": str(arguments.test),
        "size": [width, height],
        "space": "radiance" if comparison.linear else "display",
        # JSON knows no infinity, which the PSNR of equal pictures is.
        "metrics": {
            name: value if math.isfinite(value) else None
            for name, value in comparison.values.items()
        },
        "exceeded": sorted(faults),
    }
    print(json.dumps(result, indent=2))


def _limit(text: str) -> tuple[str, float]:
    name, _, number = text.partition("=")
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not name or math.isnan(value):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not METRIC=VALUE, such as flip=0.01"
        )
    return name, value
