"""What the file offers: variants of materials and cameras."""

from typing import TYPE_CHECKING, Any

from moka.ui.panels.panel import Panel
from moka.ui.widgets import choice

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["ModelPanel"]

_NO_VARIANT = "as the file has them"


class ModelPanel(Panel):
    """Chooses a variant, and looks through a camera of the file."""

    title = "Model"
    starts_open = True

    def is_useful(self, viewer: "Viewer") -> bool:
        """Whether the file offers any."""
        return viewer.model is not None and bool(
            viewer.model.model.variants or viewer.model.cameras
        )

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        model = viewer.model
        assert model is not None
        if model.model.variants:
            shown = model.variant or _NO_VARIANT
            wanted = choice(
                imgui, "materials", shown, (_NO_VARIANT, *model.model.variants)
            )
            if wanted != shown:
                model.variant = None if wanted == _NO_VARIANT else wanted
                viewer.request_redraw()
        for number, camera in enumerate(model.cameras):
            imgui.push_id(number)
            if imgui.button(camera.name or f"camera {number}"):
                viewer.look_through(camera)
            imgui.pop_id()
