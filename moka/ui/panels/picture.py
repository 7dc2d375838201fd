"""How the picture is shown: exposure, tone map, edges, background."""

from typing import TYPE_CHECKING, Any

from moka.core.tone_map import TONE_MAPS
from moka.renderer.settings import MOST_GAMMA
from moka.ui.panels.panel import Panel
from moka.ui.widgets import choice, hint, slider

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["PicturePanel"]

_SAMPLES = {"off": 1, "2": 2, "4": 4, "8": 8}


class PicturePanel(Panel):
    """Exposure, tone map, multisampling and what is behind the model."""

    title = "Picture"
    starts_open = True

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        settings = viewer.settings
        exposure = slider(
            imgui, "exposure", settings.exposure, -10, 10, "%+.2f EV"
        )
        tone_map = choice(
            imgui, "tone map", settings.tone_map, tuple(TONE_MAPS)
        )
        is_power, power = settings.gamma is not None, settings.gamma or 2.2
        _, is_power = imgui.checkbox("power gamma", is_power)
        hint(imgui, "Encodes by a power in the place of the curve of sRGB.")
        if is_power:
            power = slider(imgui, "gamma", power, 0.1, MOST_GAMMA, "%.2f")
            power = min(max(power, 0.01), MOST_GAMMA)
        names = {value: name for name, value in _SAMPLES.items()}
        samples = choice(
            imgui,
            "samples",
            names.get(settings.samples, str(settings.samples)),
            tuple(_SAMPLES),
        )
        hint(imgui, "Samples of a pixel: the more, the smoother the edges.")
        viewer.choices.change_settings(
            exposure=exposure,
            tone_map=tone_map,
            gamma=power if is_power else None,
            samples=_SAMPLES.get(samples, settings.samples),
        )
        if settings.samples > 1:
            _, viewer.draft.is_wanted = imgui.checkbox(
                "fewer in motion, if slow", viewer.draft.is_wanted
            )
            hint(
                imgui,
                "One sample a pixel while something moves, if a frame takes "
                "longer than a twentieth of a second.",
            )
        self._background(imgui, viewer)

    def _background(self, imgui: Any, viewer: "Viewer") -> None:
        scene = viewer.scene
        background = scene.background
        kind = background if isinstance(background, str) else "colour"
        wanted = choice(
            imgui, "background", kind, ("environment", "transparent", "colour")
        )
        if wanted != kind:
            scene.background = (
                wanted if wanted != "colour" else (0.05, 0.05, 0.05)
            )
        if scene.background == "environment":
            blur = slider(imgui, "blur", scene.background_blur, 0, 1, "%.2f")
            hint(imgui, "As a surface of that roughness reflects it.")
            scene.background_blur = min(max(blur, 0.0), 1.0)
        if not isinstance(scene.background, str):
            changed, colour = imgui.color_edit3(
                "colour",
                list(scene.background),
                imgui.ColorEditFlags_.float | imgui.ColorEditFlags_.hdr,
            )
            if changed:
                scene.background = tuple(max(c, 0.0) for c in colour)
