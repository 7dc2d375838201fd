"""The light around the model, and how it is computed."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moka.lighting.environment import BRIGHTEST
from moka.renderer.settings import BRDFS, DIFFUSE_MODELS, IBL_MODES
from moka.ui.panels.panel import Panel, tell_of_motion
from moka.ui.widgets import choice, file_items, hint, slider

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["EnvironmentPanel", "LightingPanel"]

_MODE_HINT = (
    "How the light of the environment is computed. split-sum: at once, as "
    "other renderers do. filtered: split-sum, corrected by samples of each "
    "pixel. reference: integrated, for as long as nothing moves. off: the "
    "environment is only seen."
)

_BUILT_IN = ("studio", "sky", "furnace", "none")


class EnvironmentPanel(Panel):
    """Which environment, how it is turned, and how bright it is."""

    title = "Environment"
    starts_open = True

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        scene = viewer.scene
        name = str(viewer.environment_source)
        files = list(viewer.preferences.recent_environments)
        if name not in _BUILT_IN and name not in files:
            files.insert(0, name)
        wanted = _picked(imgui, name, files)
        if wanted != name:
            viewer.open_environment(wanted)
        degrees = slider(
            imgui,
            "rotation",
            math.degrees(scene.environment_rotation),
            -180,
            180,
            "%.0f°",
        )
        scene.environment_rotation = math.radians(degrees)
        intensity = slider(
            imgui,
            "intensity",
            scene.environment_intensity,
            0.01,
            100,
            "%.2f",
            logarithmic=True,
        )
        # A person may type any number.
        scene.environment_intensity = min(max(intensity, 0.0), BRIGHTEST)
        imgui.text_disabled("drop a .hdr or .exr to light with it")


class LightingPanel(Panel):
    """The terms of the BRDF and the mode of image-based lighting."""

    title = "Lighting"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        settings = viewer.settings
        ibl = choice(imgui, "mode", settings.ibl, IBL_MODES)
        hint(imgui, _MODE_HINT)
        brdf = choice(imgui, "BRDF", settings.brdf, BRDFS)
        diffuse = choice(imgui, "diffuse", settings.diffuse, DIFFUSE_MODELS)
        _, multiscatter = imgui.checkbox(
            "multiple scattering", settings.multiscatter
        )
        hint(imgui, "Gives rough metals the light back that they would lose.")
        samples = settings.ibl_samples
        if ibl == "filtered":
            _, samples = imgui.slider_int("samples a pixel", samples, 1, 64)
        viewer.choices.change_settings(
            ibl=ibl,
            brdf=brdf,
            diffuse=diffuse,
            multiscatter=multiscatter,
            ibl_samples=samples,
        )
        if ibl == "reference":
            lighting = viewer.renderer.lighting_statistics
            imgui.text(f"{lighting['samples_per_pixel']:.0f} samples a pixel")
            if lighting["estimated_error"] is not None:
                imgui.text(f"error {lighting['estimated_error']:.2%}")
            tell_of_motion(imgui, viewer)


def _picked(imgui: Any, now: str, files: list[str]) -> str:
    """One of the built-in environments, or of files by their last names."""
    wanted = now
    shown = now if now in _BUILT_IN else Path(now).name
    if imgui.begin_combo("environment", shown):
        for name in _BUILT_IN:
            if imgui.selectable(name, name == now)[0]:
                wanted = name
        wanted = file_items(imgui, now, files) or wanted
        imgui.end_combo()
    return wanted
