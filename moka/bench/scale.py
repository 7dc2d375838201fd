"""Growth of a frame's time with objects, lights, pixels and more."""

import argparse
from typing import TYPE_CHECKING, Any

from moka.bench.options import add_backend_option
from moka.core.option_text import count

if TYPE_CHECKING:
    from collections.abc import Callable

    from moka.bench.scale_scenes import Subject

__all__ = ["add_arguments", "execute"]

# What grows, and how large it gets. Objects end at --largest.
SIZES = {
    "objects": (10, 100, 1_000, 10_000, 100_000),
    "visible": (50, 100),
    "materials": (1, 10, 100, 1_000),
    "lights": (1, 2, 4, 8, 16, 32, 64),
    "pixels": (256, 512, 1024, 2048, 4096),
    "textures": (256, 512, 1024, 2048, 4096),
    # Skinned and moving, skinned and still, and not skinned.
    "characters": (1, 10, 100),
    "standing": (1, 10, 100),
    "statues": (1, 10, 100),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka bench scale``."""
    add = parser.add_argument
    add(
        "--series",
        metavar="NAME,...",
        type=_series,
        default=tuple(SIZES),
        help=f"what grows: {', '.join(SIZES)} (default: all)",
    )
    add(
        "--largest",
        metavar="N",
        type=count,
        default=10_000,
        help="objects at most (default: 10000)",
    )
    add(
        "--widest",
        metavar="N",
        type=count,
        default=2048,
        help="pixels and texels along an edge at most (default: 2048)",
    )
    add(
        "--frames",
        metavar="N",
        type=count,
        default=15,
        help="how many are timed of each (default: 15)",
    )
    add_backend_option(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Measure, print tables and write what was asked for."""
    from moka.bench.measure import growth_exponent
    from moka.bench.results import check_output, write_json

    check_output(arguments.json, arguments.plot)
    result: dict[str, Any] = {"frames": arguments.frames, "series": {}}
    for name in arguments.series:
        points = [
            _point(arguments, name, size)
            for size in SIZES[name]
            if size <= _most(arguments, name)
        ]
        sizes = [point["size"] for point in points]
        exponents = {
            time: round(
                growth_exponent(
                    sizes, [point[time]["median"] for point in points]
                ),
                3,
            )
            for time in ("frame_ms", "submit_ms", "prepare_ms")
            if len(points) > 1
        }
        series = {"exponents": exponents, "points": points}
        result["series"][name] = series
        _print(name, series)
    if arguments.json:
        write_json(result, arguments.json)
    if arguments.plot:
        from moka.bench.plot import plot_growth

        plot_growth(
            {
                name: [
                    (
                        point["size"],
                        *(
                            point["frame_ms"][quantile]
                            for quantile in (
                                "median",
                                "quartile_1",
                                "quartile_3",
                            )
                        ),
                    )
                    for point in series["points"]
                ]
                for name, series in result["series"].items()
            },
            "how many, or how wide",
            arguments.plot,
        )
    return 0


def _makers() -> "dict[str, Callable[[int], Subject]]":
    from moka.bench import character_scenes as crowds
    from moka.bench import scale_scenes as scenes

    return {
        "objects": scenes.of_objects,
        "visible": scenes.of_visible,
        "materials": scenes.of_materials,
        "lights": scenes.of_lights,
        "pixels": scenes.of_pixels,
        "textures": scenes.of_textures,
        "characters": crowds.of_characters,
        "standing": crowds.of_standing,
        "statues": crowds.of_statues,
    }


def _point(
    arguments: argparse.Namespace, name: str, size: int
) -> dict[str, Any]:
    """Times and counters of one size, on a device of its own.

    ``prepare_ms`` is from the model in memory until its first frame is
    finished; the context is not part of it.
    """
    import time

    from moka.bench.measure import spread
    from moka.bench.steady import time_frames
    from moka.graphics.device import GraphicsDevice
    from moka.renderer.renderer import Renderer
    from moka.renderer.settings import RenderSettings

    with GraphicsDevice.open(
        arguments.backend, debug=arguments.debug
    ) as device:
        device.finish()
        start = time.perf_counter()
        subject = _makers()[name](size)
        settings = RenderSettings(samples=subject.samples)
        renderer = Renderer(device, subject.size, settings)
        draw = (renderer, subject.scene, subject.camera, subject.advance)
        try:
            time_frames(*draw, frames=1, warm_up=0)
            prepared = time.perf_counter() - start
            times = time_frames(*draw, frames=arguments.frames, warm_up=2)
        finally:
            renderer.close()
    return {
        "size": size,
        "frame_ms": spread(times.frame_ms).as_dict(),
        "submit_ms": spread(times.submit_ms).as_dict(),
        "prepare_ms": {"median": round(1000.0 * prepared, 3)},
        "counts": times.counts,
    }


def _print(name: str, series: dict[str, Any]) -> None:
    from moka.bench.results import format_table

    rows = [
        [
            str(point["size"]),
            point["frame_ms"]["median"],
            point["frame_ms"]["quartile_1"],
            point["frame_ms"]["quartile_3"],
            point["submit_ms"]["median"],
            point["prepare_ms"]["median"],
            point["counts"]["visible"],
            point["counts"]["gl_draws"],
            point["counts"]["programs"],
        ]
        for point in series["points"]
    ]
    header = [name, "frame ms", "quartile 1", "quartile 3", "submit ms"]
    header += ["prepare ms", "visible", "GL draws", "programs"]
    print(format_table(header, rows))
    if series["exponents"]:
        exponents = ", ".join(
            f"{time.removesuffix('_ms')} {exponent:.2f}"
            for time, exponent in series["exponents"].items()
        )
        print(f"time grows as {name} to the power of: {exponents}")
    print(flush=True)


def _most(arguments: argparse.Namespace, name: str) -> int:
    """The largest size that was asked for."""
    if name == "objects":
        return int(arguments.largest)
    if name in ("pixels", "textures"):
        return int(arguments.widest)
    return max(SIZES[name])


def _series(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    for name in names:
        if name not in SIZES:
            raise argparse.ArgumentTypeError(
                f"{name!r} is none of {', '.join(SIZES)}"
            )
    return names
