"""What a command says of the picture in the viewer, and what it cannot."""

from types import SimpleNamespace
from typing import Any

import pytest

from moka.app.render_request import RenderRequest
from moka.model import demo_model
from moka.model.lights import LightKind, PunctualLight
from moka.renderer.settings import RenderSettings
from moka.ui.picture_command import (
    beyond_command,
    copy_command,
    picture_command,
)
from moka.ui.viewer import Viewer


def a_viewer(request: RenderRequest | None = None, **settings: Any) -> Viewer:
    """One that has not begun to draw."""
    viewer = Viewer(request)
    viewer.renderer = SimpleNamespace(  # type: ignore[assignment]
        settings=RenderSettings(**settings), size=(640, 480), shows_stops=False
    )
    return viewer


def test_of_what_is_an_option_nothing_is_missing() -> None:
    viewer = a_viewer(RenderRequest("a.glb", scene="second"), exposure=1.5)
    viewer.scene.background = (0.2, 0.4, 1.0)
    command = picture_command(viewer)
    assert command.startswith("moka render a.glb --size 640x480")
    assert "--scene second" in command
    assert "--exposure 1.5" in command
    assert beyond_command(viewer) == []
    viewer.files.model_source = "b.glb"
    assert "--scene" not in picture_command(viewer)


@pytest.mark.parametrize(
    ("settings", "change", "missing"),
    [
        ({}, lambda v: v.edits.add("edited materials"), "edited materials"),
        ({}, lambda v: setattr(v, "debug_view", "normal"), "view of normal"),
        ({"light_part": "diffuse"}, lambda _: None, "diffuse light alone"),
        (
            {},
            lambda v: setattr(v.renderer, "shows_stops", True),
            "luminance in stops",
        ),
        (
            {},
            lambda v: setattr(v.comparison, "choice", "BRDF karis"),
            "the picture beside it",
        ),
        (
            {},
            lambda v: setattr(v.scene, "background", (0.0, 2.0, 0.0)),
            "brighter than white",
        ),
        (
            {},
            lambda v: setattr(v.files, "model_source", demo_model()),
            "a model that is no file",
        ),
        (
            {},
            lambda v: setattr(v.files, "environment_source", None),
            "an environment that is no file",
        ),
        (
            {},
            lambda v: v.added_lights.append(
                v.scene.add_light(PunctualLight(LightKind.POINT))
            ),
            "added lights",
        ),
    ],
)
def test_what_no_option_says_is_told(
    settings: dict[str, Any], change: Any, missing: str
) -> None:
    viewer = a_viewer(**settings)
    change(viewer)
    (told,) = beyond_command(viewer)
    assert missing in told
    viewer.window = SimpleNamespace(  # type: ignore[assignment]
        clipboard="", wake=lambda: None
    )
    copy_command(viewer)
    assert viewer.window.clipboard == picture_command(viewer)
    assert viewer.message == f"copied: moka render ..., without {told}"
