"""Render one picture of a glTF model, or of the built-in scene."""

import argparse
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from moka.cli.picture_options import add_picture_arguments, picture_request
from moka.core.errors import OptionError
from moka.core.option_text import count, number

if TYPE_CHECKING:
    from moka.core.image import Image

__all__ = ["add_arguments", "execute"]

SUFFIXES = (".png", ".exr")
# Each of them is a sequence.
MOVING_SUFFIXES = (".gif", ".webp", ".mp4")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka render``."""
    add_picture_arguments(parser)
    add = parser.add_argument
    add(
        "-o",
        "--output",
        metavar="PATH",
        type=Path,
        action="append",
        help=".png or .exr file, repeatable (default: moka.png)",
    )
    add(
        "--half",
        action="store_true",
        help="write half floats into .exr files",
    )
    add(
        "--frames",
        metavar="N",
        type=count,
        help="a sequence of N pictures, OUT.0000.png and so on, or one .gif, "
        ".webp or .mp4 (default: one run of the animation)",
    )
    add(
        "--turntable",
        action="store_true",
        help="in a sequence the camera goes once around the scene",
    )
    add(
        "--fps",
        metavar="N",
        type=number,
        help="frames per second of a sequence (default: 30)",
    )
    add(
        "--resume",
        action="store_true",
        help="leave out the frames of a sequence that are there already",
    )
    add(
        "--aov",
        metavar="NAME,...",
        default=(),
        type=_aovs,
        help="extra layers of an .exr: depth, normal, albedo, roughness, "
        "metallic, emission, occlusion, uv, object-id",
    )
    add(
        "--full-textures",
        action="store_true",
        help="decode textures in full, also where the picture cannot show it",
    )
    add(
        "--stats",
        metavar="PATH.json",
        type=Path,
        help="write stage times and counters",
    )
    add(
        "--no-cache",
        action="store_true",
        help="neither read nor write the disk cache of preintegrated "
        "lighting, see moka cache",
    )
    add(
        "--backend",
        choices=("auto", "egl", "osmesa", "window"),
        default="auto",
        help="GL context (default: auto)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Render and write every output, or write none and raise MokaError."""
    outputs = arguments.output or [Path("moka.png")]
    is_sequence = (
        arguments.frames is not None
        or arguments.turntable
        or any(path.suffix.lower() in MOVING_SUFFIXES for path in outputs)
    )
    _check_outputs(
        outputs, arguments.stats, SUFFIXES + is_sequence * MOVING_SUFFIXES
    )
    if arguments.owns_process:
        from moka.core.heap import claim_heap

        claim_heap()
        _import_msgspec()
    float_output = any(path.suffix.lower() == ".exr" for path in outputs)
    if arguments.aov and not float_output:
        raise OptionError("--aov: needs an output that ends in .exr")
    request = picture_request(
        arguments,
        float_output=float_output,
        backend=arguments.backend,
        aovs=arguments.aov,
        full_textures=arguments.full_textures,
    )
    if is_sequence:
        from moka.cli.render_sequence import render_sequence

        return render_sequence(arguments, request, outputs)
    for option in ("fps", "resume"):
        if getattr(arguments, option):
            raise OptionError(f"--{option}: needs --frames or --turntable")

    from moka.app.render import render_request
    from moka.core.statistics import Statistics, write_statistics

    statistics = Statistics(arguments.started)
    statistics.add_time("import", time.perf_counter() - arguments.started)
    suffixes = {path.suffix.lower() for path in outputs}

    def save(image: "Image") -> None:
        with statistics.stage("encode"):
            image.save_all(outputs, half=arguments.half)

    render_request(
        request,
        statistics,
        want_pixels=".exr" in suffixes,
        want_display=".png" in suffixes,
        debug=arguments.debug,
        cache=not arguments.no_cache,
        deliver=save,
    )
    if arguments.stats:
        write_statistics(statistics, arguments.stats)
    return 0


def _import_msgspec() -> None:
    """Import it without typing_extensions, which are 6 ms of its 14.

    They are for names that `typing` had not yet; this Python has them. A
    version that insists gets them when it is imported next.
    """
    if "typing_extensions" in sys.modules:
        return
    sys.modules["typing_extensions"] = None  # type: ignore[assignment]
    try:
        with suppress(ImportError):
            import msgspec as msgspec
    finally:
        del sys.modules["typing_extensions"]


def _check_outputs(
    outputs: list[Path], statistics: Path | None, suffixes: tuple[str, ...]
) -> None:
    """Find out that a file cannot be written before the work is done."""
    for path in outputs:
        if path.suffix.lower() not in suffixes:
            raise OptionError(
                f"{path}: the output needs the ending "
                f"{', '.join(suffixes[:-1])} or {suffixes[-1]}"
            )
    for path in [*outputs, *([statistics] if statistics else [])]:
        if not path.parent.is_dir():
            raise OptionError(f"{path}: the folder {path.parent} is missing")
        if path.is_dir():
            raise OptionError(f"{path}: is a folder")


def _aovs(text: str) -> tuple[str, ...]:
    from moka.core.aov import parse_aovs

    try:
        return parse_aovs(text)
    except OptionError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
