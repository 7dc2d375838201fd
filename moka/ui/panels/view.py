"""What is shown: the picture, a part of its light, or what surfaces are."""

from typing import TYPE_CHECKING, Any

from moka.renderer.debug_view import DEBUG_VIEWS
from moka.ui.panels.panel import Panel
from moka.ui.widgets import choice

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["ViewPanel"]

_PARTS = {
    "all light": "all",
    "diffuse": "diffuse",
    "specular": "specular",
    "irradiance": "irradiance",
}
_LUMINANCE = "luminance in stops"


class ViewPanel(Panel):
    """Chooses a debug view."""

    title = "View"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        views = (*_PARTS, _LUMINANCE, *DEBUG_VIEWS)
        shown = _shown(viewer)
        wanted = choice(imgui, "show", shown, views)
        if wanted == shown:
            return
        viewer.debug_view = wanted if wanted in DEBUG_VIEWS else None
        viewer.renderer.shows_stops = wanted == _LUMINANCE
        viewer.choices.change_settings(light_part=_PARTS.get(wanted, "all"))
        viewer.request_redraw()


def _shown(viewer: "Viewer") -> str:
    if viewer.debug_view is not None:
        return viewer.debug_view
    if viewer.renderer.shows_stops:
        return _LUMINANCE
    part = viewer.settings.light_part
    return next(name for name, value in _PARTS.items() if value == part)
