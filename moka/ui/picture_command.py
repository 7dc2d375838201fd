"""The picture that is seen, as the ``moka render`` command that makes it."""

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from moka.app.command_text import command_text
from moka.app.render_request import RenderRequest
from moka.renderer.settings import RenderSettings
from moka.scene.camera_choice import look_text

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["beyond_command", "copy_command", "picture_command"]


def picture_command(viewer: "Viewer") -> str:
    """The command; what it cannot say, :func:`beyond_command` does."""
    return command_text(_request(viewer))


def beyond_command(viewer: "Viewer") -> list[str]:
    """What is seen and no option of a command, for a person."""
    return list(_beyond(viewer))


def copy_command(viewer: "Viewer") -> None:
    """Put the command on the clipboard, and say what it lacks."""
    if viewer.window is None:
        return
    viewer.window.clipboard = picture_command(viewer)
    missing = beyond_command(viewer)
    lacks = f", without {', '.join(missing)}" if missing else ""
    viewer.tell(f"copied: moka render ...{lacks}")


def _request(viewer: "Viewer") -> RenderRequest:
    time, animation = 0.0, None
    if viewer.model is not None and viewer.model.model.animations:
        current = viewer.model.animations.current
        if current is not None:
            time, animation = current.time, current.animation
    scene, files = viewer.scene, viewer.files
    return replace(
        viewer.begun,
        source=files.model_source,
        environment=files.environment_source,
        environment_rotation=scene.environment_rotation,
        environment_intensity=scene.environment_intensity,
        background=scene.background,
        background_blur=scene.background_blur,
        camera=look_text(viewer.controls.look(viewer.camera)),
        size=viewer.size,
        settings=viewer.settings,
        time=time,
        animation=animation,
        scene=files.scene_of(files.model_source),
        variant=None if viewer.model is None else viewer.model.variant,
    )


def _beyond(viewer: "Viewer") -> Iterator[str]:
    files = viewer.files
    if not _can_be_named(files.model_source) and files.model_source is not None:
        yield "a model that is no file"
    if not _can_be_named(files.environment_source):
        yield "an environment that is no file"
    yield from sorted(viewer.edits)
    if viewer.added_lights:
        yield "added lights"
    background = viewer.scene.background
    if not isinstance(background, str) and max(background) > 1.0:
        yield "a background brighter than white"
    if viewer.debug_view is not None:
        yield f"the view of {viewer.debug_view}"
    elif viewer.renderer.shows_stops:
        yield "luminance in stops"
    elif viewer.settings.light_part != RenderSettings().light_part:
        yield f"{viewer.settings.light_part} light alone"
    if viewer.debug_view is None and viewer.comparison.choice is not None:
        yield "the picture beside it"


def _can_be_named(source: Any) -> bool:
    return isinstance(source, str | os.PathLike)
