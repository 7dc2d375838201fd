"""The lens, and what moves the camera by itself."""

import math
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from moka.model.cameras import Orthographic, Perspective
from moka.ui.panels.panel import Panel
from moka.ui.widgets import hint, slider

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["CameraPanel"]


class CameraPanel(Panel):
    """Field of view, projection, turning; where to look."""

    title = "Camera"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        camera = viewer.camera
        lens = camera.projection
        if isinstance(lens, Perspective):
            angle = math.degrees(lens.yfov)
            wanted = slider(imgui, "field of view", angle, 5.0, 150.0, "%.0f°")
            wanted = min(max(wanted, 1.0), 179.0)
            if wanted != angle:
                camera.projection = replace(lens, yfov=math.radians(wanted))
                viewer.request_redraw()
        _, is_parallel = imgui.checkbox(
            "parallel projection", isinstance(lens, Orthographic)
        )
        hint(imgui, "No perspective: what is far away is as large.")
        if is_parallel != isinstance(lens, Orthographic):
            viewer.controls.change_lens(camera)
            viewer.request_redraw()
        _, viewer.auto_rotates = imgui.checkbox(
            "turn around", viewer.auto_rotates
        )
        hint(imgui, "The camera goes around by itself (R).")
        if imgui.button("frame all"):
            viewer.viewpoint.frame_everything()
        hint(imgui, "Look at the whole model (Home).")
        imgui.same_line()
        imgui.begin_disabled(viewer.selection is None)
        if imgui.button("frame the selection"):
            viewer.viewpoint.frame_selection()
        imgui.end_disabled()
        hint(
            imgui,
            "Look at what is selected (F)."
            if viewer.selection is not None
            else "Click the model, or a node of the panel Scene, to select.",
        )
