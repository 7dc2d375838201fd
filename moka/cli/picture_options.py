"""The options that decide a picture: what it shows, and in which light."""

import argparse
import math
from typing import TYPE_CHECKING, Any

from moka.core.errors import OptionError
from moka.core.option_text import count, name_or_index, number, size

if TYPE_CHECKING:
    from moka.app.render_request import RenderRequest

__all__ = ["add_picture_arguments", "picture_request"]


def add_picture_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what :class:`moka.app.render_request.RenderRequest` is made of."""
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
        "--background-blur",
        metavar="X",
        type=number,
        default=0.0,
        help="blur of the environment behind the model, 0 to 1 (default: 0)",
    )
    add(
        "--camera",
        metavar="CAMERA",
        help="name or index of a glTF camera, orbit:YAW,PITCH[,DISTANCE] in "
        "degrees, or look:EX,EY,EZ,TX,TY,TZ[,FOV] from a point to another",
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
        "--gamma",
        metavar="X",
        type=number,
        help="encode a .png with the power 1 / X (default: the sRGB curve)",
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
        "--reflections",
        metavar="SIZE",
        help="full, as fine as the environment's map, or half, which is "
        "prefiltered in a fraction of the time (default: full, with --quality "
        "fast half)",
    )
    add(
        "--ibl",
        metavar="MODE",
        help="light of the environment: split-sum, filtered, reference or off "
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
        "--cull-pixels",
        metavar="N",
        type=number,
        default=0.5,
        help="leave out what looks smaller than N pixels; 0 draws everything "
        "(default: 0.5)",
    )
    add(
        "--max-error",
        metavar="E",
        type=number,
        help="relative standard error at which --ibl reference stops",
    )
    add(
        "--specular-aa",
        choices=("on", "off"),
        default="off",
        help="surfaces as rough as the bumps of a normal map that a pixel "
        "averages (default: off)",
    )
    add(
        "--anisotropy",
        metavar="N",
        type=count,
        default=1,
        help="samples of a texture seen at a grazing angle, up to 16 "
        "(default: 1)",
    )
    add(
        "--mip-filter",
        metavar="HOW",
        help="linear, which mixes two levels of a texture, or nearest, which "
        "reads one (default: linear)",
    )
    add(
        "--shading",
        metavar="WHEN",
        default="auto",
        help="shade surfaces as they are drawn (forward), or each pixel once "
        "when it is known what it sees (visibility, where the scene allows "
        "it); auto takes what is faster (default: auto)",
    )
    add(
        "--max-texture-size",
        metavar="N",
        type=count,
        help="reduce textures with more than N texels along a side",
    )


def picture_request(
    arguments: argparse.Namespace,
    *,
    float_output: bool = False,
    **options: Any,
) -> "RenderRequest":
    """What the options that :func:`add_picture_arguments` added ask for.

    ``float_output`` asks for float32 pixels; ``options`` are further fields
    of the request. Raises OptionError for what means nothing together.
    """
    from moka.app.render_request import RenderRequest
    from moka.renderer.quality import settings_of_quality

    if arguments.environment_intensity < 0:
        raise OptionError("--environment-intensity: must not be negative")
    settings = settings_of_quality(
        arguments.quality,
        exposure=arguments.exposure,
        tone_map=arguments.tone_map,
        gamma=arguments.gamma,
        samples=arguments.samples,
        brdf=arguments.brdf,
        diffuse=arguments.diffuse,
        multiscatter=arguments.multiscatter == "on",
        suns=arguments.suns,
        irradiance=arguments.irradiance,
        reflections=arguments.reflections,
        ibl=arguments.ibl,
        ibl_samples=arguments.ibl_samples,
        reference_samples=arguments.reference_samples,
        max_error=arguments.max_error,
        anisotropy=arguments.anisotropy,
        mip_filter=arguments.mip_filter,
        max_texture_size=arguments.max_texture_size,
        specular_aa=arguments.specular_aa == "on",
        shading=arguments.shading,
        float_output=float_output,
    )
    _check_lighting(arguments, settings.ibl)
    return RenderRequest(
        source=arguments.model,
        environment=arguments.environment,
        environment_rotation=math.radians(arguments.environment_rotation),
        environment_intensity=arguments.environment_intensity,
        background=arguments.background,
        background_blur=arguments.background_blur,
        camera=arguments.camera,
        size=arguments.size,
        settings=settings,
        time=arguments.time,
        animation=arguments.animation,
        scene=arguments.scene,
        variant=arguments.variant,
        **options,
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
        for option in ("suns", "irradiance", "reflections"):
            if getattr(arguments, option) not in (None, "auto", "full"):
                raise OptionError(
                    f"--{option}: --ibl reference samples the environment "
                    "as it is; leave it out"
                )


def _suns(text: str) -> str | int:
    if text in ("auto", "off"):
        return text
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not auto, off or 1, 2…")
    return int(text)
