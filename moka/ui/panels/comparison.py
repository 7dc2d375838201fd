"""What stands beside the picture, and how far it is from the truth."""

from typing import TYPE_CHECKING, Any

from moka.ui.comparison import COMPARISONS
from moka.ui.panels.panel import Panel, tell_of_motion
from moka.ui.widgets import choice, hint

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["ComparisonPanel"]

_NOTHING = "nothing"


class ComparisonPanel(Panel):
    """Splits the view, and measures the error of the lighting."""

    title = "Compare"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        comparison = viewer.comparison
        shown = comparison.choice or _NOTHING
        wanted = choice(imgui, "beside", shown, (_NOTHING, *COMPARISONS))
        if wanted != shown:
            viewer.choices.compare_with(None if wanted == _NOTHING else wanted)
        if comparison.choice is not None:
            imgui.text_disabled("drag the line in the picture")
            self._progress(imgui, viewer)
        self._error(imgui, viewer)

    def _progress(self, imgui: Any, viewer: "Viewer") -> None:
        other = viewer.comparison.renderer
        if other is None or other.settings.ibl != "reference":
            return
        lighting = other.lighting_statistics
        imgui.text(f"{lighting['samples_per_pixel']:.0f} samples a pixel")
        tell_of_motion(imgui, viewer)

    def _error(self, imgui: Any, viewer: "Viewer") -> None:
        imgui.separator()
        measurement = viewer.measurement
        is_running = measurement is not None and not measurement.is_done
        is_truth = viewer.settings.ibl == "reference"
        imgui.begin_disabled(is_running or is_truth or viewer.model is None)
        if imgui.button("measure the error of the light"):
            viewer.measure_error()
        imgui.end_disabled()
        hint(
            imgui,
            "Renders this view in the mode of the panel Lighting and by "
            "reference lighting, and compares the radiance of the surfaces.",
        )
        if is_truth:
            imgui.text_wrapped("This is the reference lighting itself.")
        if measurement is None:
            return
        if not measurement.is_done:
            imgui.progress_bar(measurement.progress)
            return
        result = measurement.result
        mode = measurement.measured.ibl
        if result is None:
            imgui.text("nothing is lit here")
            return
        imgui.text(f"{mode}, {result.pixels} pixels")
        for name, value in (
            ("relative RMSE", result.relative_rmse),
            ("median error", result.median),
            ("noise of the truth", result.truth_error),
        ):
            if value is not None:
                imgui.text_disabled(name)
                imgui.same_line(12 * imgui.get_font_size())
                imgui.text(f"{value:.2%}")
