"""The ``moka render`` command that makes the picture of a request."""

import math
import os
import shlex
from typing import Any

from moka.app.render_request import RenderRequest
from moka.renderer.settings import RenderSettings

__all__ = ["command_arguments", "command_text"]


def command_text(request: RenderRequest, output: str = "moka.png") -> str:
    """The command as a shell takes it; see :func:`command_arguments`."""
    return shlex.join(
        ["moka", "render", *command_arguments(request), "-o", output]
    )


def command_arguments(request: RenderRequest) -> list[str]:
    """What follows ``moka render``; options with their defaults are left out.

    A model, an environment or a camera that is not from a file, by name or
    an orbit cannot be told and is left out too.
    """
    plain = RenderRequest()
    given: list[str] = []

    def add(name: str, value: Any, default: Any) -> None:
        if value != default:
            given.extend((f"--{name}", str(value)))

    if isinstance(request.source, str | os.PathLike):
        given.append(os.fspath(request.source))
    width, height = request.size
    add("size", f"{width}x{height}", "1280x720")
    if isinstance(request.environment, str | os.PathLike):
        add("environment", os.fspath(request.environment), plain.environment)
    degrees = round(math.degrees(request.environment_rotation), 6)
    add("environment-rotation", _number(degrees), "0")
    intensity = _number(request.environment_intensity)
    add("environment-intensity", intensity, "1")
    add("background", _background(request.background), "environment")
    add("background-blur", _number(request.background_blur), "0")
    if isinstance(request.camera, str | int):
        add("camera", request.camera, None)
    if request.time:
        add("time", _number(request.time), "0")
    add("animation", request.animation, None)
    add("scene", request.scene, None)
    add("variant", request.variant, None)
    _add_settings(add, request.settings)
    if request.aovs:
        add("aov", ",".join(request.aovs), "")
    if request.full_textures:
        given.append("--full-textures")
    add("backend", request.backend, plain.backend)
    return given


def _add_settings(add: Any, settings: RenderSettings) -> None:
    plain = RenderSettings()
    add("exposure", _number(settings.exposure), "0")
    if settings.gamma is not None:
        add("gamma", _number(settings.gamma), None)
    for name in ("tone_map", "samples", "brdf", "diffuse"):
        add(
            name.replace("_", "-"),
            getattr(settings, name),
            getattr(plain, name),
        )
    add("multiscatter", "on" if settings.multiscatter else "off", "on")
    add("anisotropy", settings.anisotropy, plain.anisotropy)
    add("mip-filter", settings.mip_filter, plain.mip_filter)
    add("max-texture-size", settings.max_texture_size, None)
    add("specular-aa", "on" if settings.specular_aa else "off", "off")
    add("shading", settings.shading, plain.shading)
    add("cull-pixels", _number(settings.cull_pixels), "0.5")
    add("ibl", settings.ibl, plain.ibl)
    if settings.ibl == "reference":
        # It samples the environment as it is, with suns and all.
        add("reference-samples", settings.reference_samples, None)
        add("max-error", settings.max_error, None)
        return
    add("suns", settings.suns, plain.suns)
    add("irradiance", settings.irradiance, plain.irradiance)
    add("reflections", settings.reflections, plain.reflections)
    if settings.ibl == "filtered":
        add("ibl-samples", settings.ibl_samples, plain.ibl_samples)


def _number(value: float) -> str:
    """The shortest text that means the same number."""
    return f"{value:g}" if float(f"{value:g}") == value else repr(float(value))


def _background(value: Any) -> str:
    """As ``--background`` takes it; a colour is linear."""
    if isinstance(value, str):
        return value
    from moka.core.colour import encode_srgb8

    return "#" + bytes(encode_srgb8(value).tolist()).hex()
