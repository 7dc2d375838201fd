"""Time to preintegrate environments, or to find them cached."""

import argparse
from typing import TYPE_CHECKING, Any

from moka.bench.options import add_backend_option, counts
from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Callable

    from moka.graphics.device import GraphicsDevice
    from moka.lighting.environment import Environment

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench lighting``."""
    add = parser.add_argument
    add(
        "environment",
        metavar="ENVIRONMENT",
        nargs="?",
        help=".hdr or .exr map, or studio or sky, at its own size "
        "(default: random maps with a sun, of several sizes)",
    )
    add(
        "--heights",
        metavar="N,...",
        type=counts,
        default=(128, 256, 512, 1024),
        help="rows of the random maps, which are twice as wide "
        "(default: 128,256,512,1024)",
    )
    add(
        "--runs",
        metavar="N",
        type=count,
        default=7,
        help="of each, after one that is not counted (default: 7)",
    )
    add_backend_option(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print a table and write what was asked for."""
    from moka.bench.measure import growth_exponent
    from moka.bench.results import check_output, write_json
    from moka.graphics.device import GraphicsDevice

    check_output(arguments.json, arguments.plot)
    with GraphicsDevice.open(
        arguments.backend, debug=arguments.debug
    ) as device:
        renderer = device.info.renderer
        points = [
            _point(device, arguments.runs, environment)
            for environment in _environments(arguments)
        ]
    rows = [point["rows"] for point in points]
    exponents = {
        step: round(
            growth_exponent(rows, [point[step]["median"] for point in points]),
            3,
        )
        for step in ("split_ms", "make_ms", "find_ms")
        if len(points) > 1
    }
    result = {"renderer": renderer, "exponents": exponents, "points": points}
    _print(result)
    if arguments.json:
        write_json(result, arguments.json)
    if arguments.plot:
        _plot(arguments, points)
    return 0


def _environments(arguments: argparse.Namespace) -> "list[Environment]":
    import numpy as np

    from moka.core.errors import OptionError
    from moka.lighting.environment import Environment, load_environment

    if arguments.environment:
        found = load_environment(arguments.environment)
        if found is None or found.is_uniform:
            raise OptionError(
                f"{arguments.environment}: there is nothing to preintegrate"
            )
        return [found]
    environments = []
    for height in arguments.heights:
        pixels = np.random.default_rng(1).random(
            (height, 2 * height, 3), np.float32
        )
        pixels[height // 4, height // 2] = 40.0 * height * height
        environments.append(Environment(pixels, name=f"random {height}"))
    return environments


def _point(
    device: "GraphicsDevice", runs: int, environment: "Environment"
) -> dict[str, Any]:
    """Times of one environment, each until the GPU has finished.

    ``split_ms`` is what the CPU does of ``make_ms``; ``find_ms`` reads the
    same from the disk cache, the digest of the texels included.
    """
    import tempfile
    from pathlib import Path

    from moka.bench.measure import milliseconds_in_turn
    from moka.graphics.passes import FullscreenPasses
    from moka.lighting.disk_cache import DiskCache
    from moka.lighting.environment import Environment
    from moka.lighting.environment_lighting import LightingRequest
    from moka.lighting.lighting_maker import LightingMaker
    from moka.lighting.spherical_harmonics import (
        irradiance_error,
        irradiance_harmonics,
    )
    from moka.lighting.suns import AUTO_SUNS, split_environment

    def request() -> LightingRequest:
        # Another one each time, whose digest is not known yet.
        again = Environment(environment.pixels, environment.suns)
        return LightingRequest(again, AUTO_SUNS, specular=True, irradiance=True)

    def finished(maker: LightingMaker) -> None:
        lighting = maker.make(request())
        lighting.maps.fill()
        device.finish()
        lighting.maps.destroy(device)

    def split() -> None:
        found = split_environment(environment)
        irradiance_error(found.base, irradiance_harmonics(found.base))

    passes = FullscreenPasses(device)
    with tempfile.TemporaryDirectory() as folder:
        cache = DiskCache(Path(folder))
        maker = LightingMaker(device, passes)
        finder = LightingMaker(device, passes, cache)
        first = finder.make(request())
        finder.keep()
        levels = first.maps.specular_levels
        first.maps.destroy(device)
        jobs: dict[str, Callable[[], None]] = {
            "split_ms": split,
            "make_ms": lambda: finished(maker),
            "find_ms": lambda: finished(finder),
        }
        times = milliseconds_in_turn(jobs, runs)
        size = cache.usage().size
    height, width, _ = environment.pixels.shape
    return {
        "name": environment.name,
        "rows": height,
        "columns": width,
        **times,
        "counts": {
            "prefiltered_levels": levels,
            "suns": len(first.suns),
            "bytes_in_cache": size,
        },
    }


def _print(result: dict[str, Any]) -> None:
    from moka.bench.results import format_table

    rows = [
        [
            f"{point['name']}, {point['columns']} x {point['rows']}",
            point["split_ms"]["median"],
            point["make_ms"]["median"],
            point["make_ms"]["quartile_1"],
            point["make_ms"]["quartile_3"],
            point["find_ms"]["median"],
            point["counts"]["prefiltered_levels"],
            f"{point['counts']['bytes_in_cache'] / (1 << 20):.1f}",
        ]
        for point in result["points"]
    ]
    header = ["map", "CPU ms", "make ms", "quartile 1", "quartile 3"]
    header += ["find ms", "levels", "MiB on disk"]
    print(format_table(header, rows))
    for step, exponent in result["exponents"].items():
        name = step.removesuffix("_ms")
        print(f"{name}: time grows as rows to the power of {exponent:.2f}")


def _plot(arguments: argparse.Namespace, points: list[dict[str, Any]]) -> None:
    from moka.bench.plot import plot_growth

    plot_growth(
        {
            name: [
                (
                    point["rows"],
                    point[step]["median"],
                    point[step]["quartile_1"],
                    point[step]["quartile_3"],
                )
                for point in points
            ]
            for name, step in (
                ("of it CPU", "split_ms"),
                ("make", "make_ms"),
                ("find in the cache", "find_ms"),
            )
        },
        "rows of the map",
        arguments.plot,
    )
