"""Which file is open, and what it offers: variants and cameras."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from moka.ui.panels.panel import Panel
from moka.ui.widgets import choice, file_items, hint

if TYPE_CHECKING:
    from moka.scene.camera import Camera
    from moka.ui.viewer import Viewer

__all__ = ["ModelPanel"]

_NO_VARIANT = "as the file has them"


class ModelPanel(Panel):
    """Opens models, chooses a variant, and looks through their cameras."""

    title = "Model"
    starts_open = True

    def __init__(self) -> None:
        self._path = ""

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        self._open(imgui, viewer)
        model = viewer.model
        if model is None:
            return
        if model.model.variants:
            shown = model.variant or _NO_VARIANT
            wanted = choice(
                imgui, "materials", shown, (_NO_VARIANT, *model.model.variants)
            )
            if wanted != shown:
                model.variant = None if wanted == _NO_VARIANT else wanted
                viewer.request_redraw()
        _cameras(imgui, viewer, model.cameras)

    def _open(self, imgui: Any, viewer: "Viewer") -> None:
        now = viewer.files.model_source
        recent = viewer.preferences.recent_models
        shown = Path(now).name if isinstance(now, str | Path) else "demo"
        if imgui.begin_combo("file", shown):
            if imgui.selectable("demo", now is None)[0]:
                viewer.open_model(None)
            wanted = file_items(imgui, str(now), recent)
            if wanted is not None:
                viewer.open_model(wanted)
            imgui.end_combo()
        entered, self._path = imgui.input_text_with_hint(
            "path",
            "open a .gltf or .glb",
            self._path,
            imgui.InputTextFlags_.enter_returns_true,
        )
        if entered and self._path:
            viewer.open(Path(self._path).expanduser())


def _cameras(imgui: Any, viewer: "Viewer", cameras: "list[Camera]") -> None:
    """Those of the file, to look through."""
    if not cameras:
        return
    if imgui.begin_combo("look through", "a camera of the file"):
        for number, camera in enumerate(cameras):
            imgui.push_id(number)
            if imgui.selectable(camera.name or f"camera {number}", False)[0]:
                viewer.viewpoint.look_through(camera)
            imgui.pop_id()
        imgui.end_combo()
    hint(imgui, "C looks through the next one.")
