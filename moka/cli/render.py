"""Render one picture of a glTF model, or of the built-in scene."""

import argparse
import math
import time
from pathlib import Path
from typing import TYPE_CHECKING

from moka.core.errors import OptionError
from moka.core.option_text import count, name_or_index, number, size

if TYPE_CHECKING:
    from moka.app.render_session import RenderRequest

__all__ = ["add_arguments", "execute"]

SUFFIXES = (".png", ".exr")
# Each of them is a sequence.
MOVING_SUFFIXES = (".gif", ".webp", ".mp4")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka render``."""
    add = parser.add_argument
    add(
        "model",
        metavar="MODEL",
        nargs="?",
        help=".gltf or .glb file (default: the built-in demo scene)",
    )
    add(
        "-o",
        "--output",
        metavar="PATH",
        type=Path,
        action="append",
        help=".png or .exr file, repeatable (default: moka.png)",
    )
    add(
        "--size",
        metavar="WxH",
        type=size,
        default=(1280, 720),
        help="pixels (default: 1280x720)",
    )
    add(
        "--environment",
        metavar="PATH|NAME",
        default="studio",
        help=".hdr or .exr equirectangular map, or studio, sky, furnace, "
        "none (default: studio)",
    )
    add(
        "--environment-rotation",
        metavar="DEG",
        type=number,
        default=0.0,
        help="counter-clockwise about +Y (default: 0)",
    )
    add(
        "--environment-intensity",
        metavar="X",
        type=number,
        default=1.0,
        help="radiance multiplier (default: 1)",
    )
    add(
        "--background",
        metavar="WHAT",
        default="environment",
        help="environment, transparent or #rrggbb (default: environment)",
    )
    add(
        "--camera",
        metavar="CAMERA",
        help="name or index of a glTF camera, or "
        "orbit:YAW,PITCH[,DISTANCE] in degrees",
    )
    add(
        "--time",
        metavar="S",
        type=number,
        default=0.0,
        help="seconds into the animation of an animated model (default: 0)",
    )
    add(
        "--animation",
        metavar="NAME|INDEX",
        help="which animation poses the model (default: the first)",
    )
    add(
        "--scene",
        metavar="SCENE",
        type=name_or_index,
        help="name or index of a scene (default: the one that the file names)",
    )
    add(
        "--variant",
        metavar="VARIANT",
        type=name_or_index,
        help="name or index of a variant of materials (default: none)",
    )
    add(
        "--exposure",
        metavar="EV",
        type=number,
        default=0.0,
        help="stops (default: 0)",
    )
    add(
        "--tone-map",
        metavar="NAME",
        default="neutral",
        help="neutral, aces, agx, reinhard, exponential, none "
        "(default: neutral)",
    )
    add(
        "--samples",
        metavar="N",
        type=count,
        default=4,
        help="multisampling, 1 turns it off (default: 4)",
    )
    add(
        "--multiscatter",
        choices=("on", "off"),
        default="on",
        help="energy compensation for multiple scattering (default: on)",
    )
    add(
        "--brdf",
        metavar="NAME",
        default="gltf",
        help="gltf, karis, blinn-phong (default: gltf)",
    )
    add(
        "--diffuse",
        metavar="NAME",
        default="lambert",
        help="lambert, oren-nayar, burley (default: lambert)",
    )
    add(
        "--quality",
        metavar="NAME",
        help="fast, balanced, best: the light of the environment as a named "
        "point of the chart of error against time; the options below change "
        "it (default: balanced)",
    )
    add(
        "--suns",
        metavar="N",
        type=_suns,
        help="bright compact parts of the environment lit as lights: auto, "
        "off or how many at most (default: auto)",
    )
    add(
        "--irradiance",
        metavar="HOW",
        help="diffuse light from spherical harmonics (sh) or a cube, or "
        "auto, which decides by their error (default: auto)",
    )
    add(
        "--ibl",
        metavar="MODE",
        help="light of the environment: split-sum, filtered, reference "
        "(default: split-sum)",
    )
    add(
        "--ibl-samples",
        metavar="N",
        type=count,
        help="samples a pixel of --ibl filtered (default: 16, with --quality "
        "best 32)",
    )
    add(
        "--reference-samples",
        metavar="N",
        type=count,
        help="samples a pixel of --ibl reference (default: 1024; with "
        "--max-error 16384 at most)",
    )
    add(
        "--max-error",
        metavar="E",
        type=number,
        help="relative standard error at which --ibl reference stops",
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
    request = _request(arguments, outputs)
    if is_sequence:
        from moka.cli.render_sequence import render_sequence

        return render_sequence(arguments, request, outputs)
    for option in ("fps", "resume"):
        if getattr(arguments, option):
            raise OptionError(f"--{option}: needs --frames or --turntable")

    from moka.app.render import render_request
    from moka.core.image import Image
    from moka.core.statistics import Statistics, write_statistics

    statistics = Statistics(arguments.started)
    statistics.add_time("import", time.perf_counter() - arguments.started)
    suffixes = {path.suffix.lower() for path in outputs}

    def save(image: Image) -> None:
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


def _request(
    arguments: argparse.Namespace, outputs: list[Path]
) -> "RenderRequest":
    from moka.app.render_session import RenderRequest
    from moka.renderer.quality import settings_of_quality

    if arguments.environment_intensity < 0:
        raise OptionError("--environment-intensity: must not be negative")
    settings = settings_of_quality(
        arguments.quality,
        exposure=arguments.exposure,
        tone_map=arguments.tone_map,
        samples=arguments.samples,
        brdf=arguments.brdf,
        diffuse=arguments.diffuse,
        multiscatter=arguments.multiscatter == "on",
        suns=arguments.suns,
        irradiance=arguments.irradiance,
        ibl=arguments.ibl,
        ibl_samples=arguments.ibl_samples,
        reference_samples=arguments.reference_samples,
        max_error=arguments.max_error,
        float_output=any(path.suffix.lower() == ".exr" for path in outputs),
    )
    _check_lighting(arguments, settings.ibl)
    if arguments.aov and not settings.float_output:
        raise OptionError("--aov: needs an output that ends in .exr")
    return RenderRequest(
        source=arguments.model,
        environment=arguments.environment,
        environment_rotation=math.radians(arguments.environment_rotation),
        environment_intensity=arguments.environment_intensity,
        background=arguments.background,
        camera=arguments.camera,
        size=arguments.size,
        settings=settings,
        backend=arguments.backend,
        aovs=arguments.aov,
        full_textures=arguments.full_textures,
        time=arguments.time,
        animation=arguments.animation,
        scene=arguments.scene,
        variant=arguments.variant,
    )


def _check_lighting(arguments: argparse.Namespace, ibl: str) -> None:
    """Refuse options that ``ibl``, the mode of lighting, does not look at."""
    for name, mode in (
        ("ibl_samples", "filtered"),
        ("reference_samples", "reference"),
        ("max_error", "reference"),
    ):
        if getattr(arguments, name) is not None and ibl != mode:
            option = name.replace("_", "-")
            raise OptionError(f"--{option}: needs --ibl {mode}")
    if ibl == "reference":
        for option in ("suns", "irradiance"):
            if getattr(arguments, option) not in (None, "auto"):
                raise OptionError(
                    f"--{option}: --ibl reference samples the environment "
                    "as it is; leave it out"
                )


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


def _suns(text: str) -> str | int:
    if text in ("auto", "off"):
        return text
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not auto, off or 1, 2…")
    return int(text)
