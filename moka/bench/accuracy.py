"""Error of every mode of lighting against time."""

import argparse
from typing import TYPE_CHECKING

from moka.bench.options import add_backend_option
from moka.core.errors import OptionError
from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from moka.bench.accuracy_results import UnderEnvironment
    from moka.bench.spheres import SphereGrid

__all__ = ["add_arguments", "execute"]

_ROUGHNESSES = (0.0, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
_QUICK_ROUGHNESSES = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
_QUICK_SUBSTANCES = ("black dielectric", "clay", "gold")

# diameter of a sphere in pixels, samples of the truth, rounds of times
_THOROUGH = (16, 4096, 5)
_QUICK = (12, 1024, 3)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench accuracy``."""
    add = parser.add_argument
    add(
        "--environments",
        metavar="PATH|NAME",
        nargs="+",
        default=["studio", "sky"],
        help="equirectangular maps or names of built-in ones, each lights "
        "the spheres once (default: studio sky)",
    )
    add(
        "--quick",
        action="store_true",
        help="a few minutes: fewer and smaller spheres, fewer modes, samples "
        "and rounds",
    )
    add(
        "--diameter",
        metavar="N",
        type=count,
        help="pixels from side to side of a sphere, even "
        f"(default: {_THOROUGH[0]}, quick {_QUICK[0]})",
    )
    add(
        "--truth-samples",
        metavar="N",
        type=count,
        help="samples a pixel of what is taken for the truth "
        f"(default: {_THOROUGH[1]}, quick {_QUICK[1]})",
    )
    add(
        "--rounds",
        metavar="N",
        type=count,
        help="how often each time is taken "
        f"(default: {_THOROUGH[2]}, quick {_QUICK[2]})",
    )
    add(
        "--multiscatter",
        choices=("on", "off"),
        default="off",
        help="energy compensation, of the truth too; single scattering can "
        "be compared with other renderers (default: off)",
    )
    add_backend_option(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print a table and write what was asked for."""
    from moka.bench.accuracy_results import as_json, format_results
    from moka.bench.results import check_output, write_json

    check_output(arguments.json, arguments.plot)
    if arguments.plot:
        from moka.bench.accuracy_plot import plot_accuracy
        from moka.bench.plot import new_figure

        # What is missing is said now and not after minutes of measuring.
        new_figure((1.0, 1.0))
    grid = _grid(arguments)
    results, driver, timed_size = _measure(arguments, grid)
    print("times of {} x {} pixels on {}".format(*timed_size, driver))
    print(format_results(results))
    if arguments.json:
        write_json(
            {"gl": driver, "timed_size": timed_size} | as_json(grid, results),
            arguments.json,
        )
    if arguments.plot:
        plot_accuracy(results, arguments.plot)
    return 0


def _grid(arguments: argparse.Namespace) -> "SphereGrid":
    from moka.bench.spheres import MATERIALS, SphereGrid

    diameter = arguments.diameter or _defaults(arguments)[0]
    if diameter % 2 or diameter > 512:
        raise OptionError(
            f"--diameter: {diameter} is not an even number up to 512"
        )
    if not arguments.quick:
        return SphereGrid(MATERIALS, _ROUGHNESSES, diameter)
    substances = tuple(
        each for each in MATERIALS if each.name in _QUICK_SUBSTANCES
    )
    return SphereGrid(substances, _QUICK_ROUGHNESSES, diameter)


def _measure(
    arguments: argparse.Namespace, grid: "SphereGrid"
) -> "tuple[Sequence[UnderEnvironment], str, tuple[int, int]]":
    from moka.bench.accuracy_results import UnderEnvironment
    from moka.bench.lighting_measure import LightingBench
    from moka.bench.lighting_modes import lighting_modes, truth_settings
    from moka.graphics.device import GraphicsDevice
    from moka.lighting.environment import load_environment
    from moka.renderer.settings import RenderSettings

    _, samples, rounds = _defaults(arguments)
    samples = arguments.truth_samples or samples
    rounds = arguments.rounds or rounds
    environments = {
        str(name): load_environment(name) for name in arguments.environments
    }
    base = RenderSettings(
        samples=1,
        multiscatter=arguments.multiscatter == "on",
        float_output=True,
    )
    modes = lighting_modes(base, quick=arguments.quick)
    most = max(mode.samples for mode in modes)
    if samples < 2 * most:
        raise OptionError(
            f"--truth-samples: {samples} are no truth for a mode of {most}; "
            f"take at least {2 * most}"
        )
    results = []
    with GraphicsDevice.open(
        arguments.backend, debug=arguments.debug
    ) as device:
        bench = LightingBench(
            device, grid, modes, truth_settings(base, samples)
        )
        try:
            for name, environment in environments.items():
                if environment is None:
                    raise OptionError(
                        f"--environments {name}: without light there is "
                        "nothing to compare"
                    )
                truth = bench.truth(environment)
                points = bench.measure(environment, truth, rounds)
                results.append(UnderEnvironment(name, samples, tuple(points)))
            return results, device.info.renderer, bench.timed_size
        finally:
            bench.close()


def _defaults(arguments: argparse.Namespace) -> tuple[int, int, int]:
    return _QUICK if arguments.quick else _THOROUGH
