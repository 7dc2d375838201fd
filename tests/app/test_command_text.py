"""A request as a command, and the command as that request again."""

import math
import shlex
from typing import Any

import pytest

from moka.app.command_text import command_arguments, command_text
from moka.app.render_request import RenderRequest
from moka.cli.main import _parser
from moka.cli.picture_options import picture_request
from moka.renderer.settings import RenderSettings


def read_back(arguments: list[str]) -> RenderRequest:
    """What ``moka render`` makes of its arguments."""
    given = ["render", *arguments]
    parsed = _parser(given).parse_args(given)
    return picture_request(
        parsed,
        backend=parsed.backend,
        aovs=parsed.aov,
        full_textures=parsed.full_textures,
    )


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"source": "a model.glb", "size": (640, 480)},
        {
            "environment": "sky",
            "environment_rotation": math.radians(12.5),
            "environment_intensity": 0.1,
            "background": "transparent",
        },
        {"background_blur": 0.25, "camera": "look:1,2,3,-4,5,6,70"},
        {"camera": "orbit:30,-15.5,2.25", "time": 1.5, "animation": "Run"},
        {"camera": "front", "scene": "second", "variant": "blue"},
        {
            "settings": RenderSettings(
                exposure=-0.25,
                tone_map="aces",
                gamma=2.2,
                reflections="half",
                samples=1,
                brdf="karis",
                diffuse="burley",
                multiscatter=False,
                suns=3,
                irradiance="cube",
                ibl="filtered",
                ibl_samples=8,
                anisotropy=8,
                max_texture_size=2048,
                specular_aa=True,
            )
        },
        {
            "settings": RenderSettings(
                ibl="reference", reference_samples=64, max_error=0.01
            )
        },
        {"aovs": ("depth", "normal"), "full_textures": True, "backend": "egl"},
    ],
)
def test_the_command_asks_for_the_same_picture(
    changes: dict[str, Any],
) -> None:
    request = RenderRequest(**changes)
    assert read_back(command_arguments(request)) == request


def test_a_linear_colour_becomes_the_code_that_shows_it() -> None:
    arguments = command_arguments(RenderRequest(background=(1.0, 0.0, 0.5)))
    assert arguments == ["--background", "#ff00bc"]


def test_the_text_is_for_a_shell() -> None:
    text = command_text(RenderRequest(source="it's.glb"), "my picture.png")
    words = shlex.split(text)
    assert words == ["moka", "render", "it's.glb", "-o", "my picture.png"]
