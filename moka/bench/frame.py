"""Time of a frame of a steady orbit around a model."""

import argparse
import math
import shlex
from typing import TYPE_CHECKING, Any

from moka.bench.options import add_scene_options
from moka.core.option_text import count, number

if TYPE_CHECKING:
    from moka.bench.steady import FrameTimes

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench frame``."""
    add_scene_options(parser, (1024, 1024))
    parser.add_argument(
        "--frames",
        metavar="N",
        type=count,
        default=60,
        help="how many are timed (default: 60)",
    )
    parser.add_argument(
        "--warm-up",
        metavar="N",
        type=count,
        default=3,
        help="frames before them that are not (default: 3)",
    )
    parser.add_argument(
        "--yaw-per-frame",
        metavar="DEG",
        type=number,
        default=1.0,
        help="how far the camera goes around in a frame (default: 1)",
    )
    parser.add_argument(
        "--shading",
        metavar="WHEN",
        default="auto",
        help="forward, visibility or auto, as in moka render (default: auto)",
    )
    parser.add_argument(
        "--against",
        metavar="COMMAND",
        help="take turns, frame by frame, with a program that draws one for "
        "each line it reads and prints its wall and CPU time in ms; print the "
        "ratios of the times",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print a table and write what was asked for."""
    from moka.bench.measure import spread
    from moka.bench.results import check_output, format_table, write_json

    check_output(arguments.json, arguments.plot)
    rival: list[tuple[float, float]] = []
    times = _measure(arguments, rival)
    rows = [
        [name, series.median, series.quartile_1, series.quartile_3, series.p95]
        for name, series in (
            ("frame", spread(times.frame_ms)),
            ("of it submit", spread(times.submit_ms)),
        )
    ]
    header = ["ms", "median", "quartile 1", "quartile 3", "p95"]
    print(format_table(header, rows))
    for name, value in times.counts.items():
        print(f"{name:24} {value}")
    result = _result(times)
    if rival:
        # The first of its frames are warm-up too.
        compared = _compare(times, rival[-len(times.frame_ms) :])
        result["against"] = {"command": arguments.against, **compared}
        print(f"of {arguments.against}:")
        for name in ("frame", "cpu"):
            print(f"{name:24} {compared[name]}")
    if arguments.json:
        write_json(result, arguments.json)
    if arguments.plot:
        from moka.bench.plot import plot_histogram

        plot_histogram(
            {"frame": times.frame_ms, "submit": times.submit_ms},
            arguments.plot,
        )
    return 0


def _result(times: "FrameTimes") -> dict[str, Any]:
    """What the JSON file holds."""
    from moka.bench.measure import spread

    frame = spread(times.frame_ms)
    return {
        "frame_ms": {
            "median": round(frame.median, 4),
            "p95": round(frame.p95, 4),
            "submit_median": round(spread(times.submit_ms).median, 4),
        },
        "counts": times.counts,
    }


def _compare(
    times: "FrameTimes", rival: list[tuple[float, float]]
) -> dict[str, Any]:
    """Ratios of wall and CPU time to those of the rival's (N,) frames."""
    from moka.bench.measure import ratio_of_pairs

    wall, cpu = zip(*rival, strict=True)
    return {
        "frame": ratio_of_pairs(times.frame_ms, wall).as_dict(),
        "cpu": ratio_of_pairs(times.cpu_ms, cpu).as_dict(),
    }


def _measure(
    arguments: argparse.Namespace, rival: list[tuple[float, float]]
) -> "FrameTimes":
    """The times, and those of a rival's frames, if there is one."""
    from contextlib import ExitStack

    from moka.bench.steady import Orbit, time_frames
    from moka.core.resources import asset_folder
    from moka.graphics.device import GraphicsDevice
    from moka.lighting.environment import load_environment
    from moka.model.load import load_model
    from moka.renderer.renderer import Renderer
    from moka.renderer.settings import RenderSettings
    from moka.scene.camera import Camera
    from moka.scene.scene import Scene

    scene = Scene()
    scene.add(load_model(arguments.model or asset_folder() / "demo.glb"))
    scene.environment = load_environment(arguments.environment)
    camera = Camera()
    width, height = arguments.size
    step = math.radians(arguments.yaw_per_frame)
    settings = RenderSettings(
        samples=arguments.samples, shading=arguments.shading
    )
    with ExitStack() as stack:
        between = None
        if arguments.against:
            from moka.bench.rival import Rival

            opponent = stack.enter_context(
                Rival(shlex.split(arguments.against))
            )
            between = lambda: rival.append(opponent.draw())  # noqa: E731
        device = stack.enter_context(
            GraphicsDevice.open(arguments.backend, debug=arguments.debug)
        )
        renderer = Renderer(device, arguments.size, settings)
        try:
            return time_frames(
                renderer,
                scene,
                camera,
                Orbit(scene, camera, width / height, step),
                arguments.frames,
                arguments.warm_up,
                between=between,
            )
        finally:
            renderer.close()
