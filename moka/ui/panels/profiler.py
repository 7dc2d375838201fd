"""Where the time goes, and how much work is done and skipped."""

from typing import TYPE_CHECKING, Any

import numpy as np

from moka.ui.frame_times import FRAMES, History
from moka.ui.panels.panel import Panel

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["ProfilerPanel"]

# The lengths of axis that the plot may have, in milliseconds.
_SCALES = (5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)


class ProfilerPanel(Panel):
    """Times of stages and passes, as means and over the last frames."""

    title = "Profiler"

    def __init__(self) -> None:
        self._plots: Any = None

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The plot and the tables."""
        times = viewer.times
        times.wants_gpu = True
        self._plot(imgui, times.cpu, times.gpu)
        _table(imgui, "CPU, ms", times.cpu)
        if times.gpu.series:
            _table(imgui, "GPU, ms", times.gpu)
        else:
            imgui.text_disabled("no times of the GPU yet")
        self._counters(imgui, viewer)

    def close(self) -> None:
        """Forget the plots."""
        if self._plots is not None:
            from imgui_bundle import implot

            implot.destroy_context(self._plots)
            self._plots = None

    def _plot(self, imgui: Any, cpu: History, gpu: History) -> None:
        from imgui_bundle import implot

        if self._plots is None:
            self._plots = implot.create_context()
        implot.set_current_context(self._plots)
        most = max(float(cpu.total.max()), float(gpu.total.max()))
        top = next((each for each in _SCALES if each > most), most)
        flags = implot.Flags_.no_inputs | implot.Flags_.no_mouse_text
        height = 8 * imgui.get_text_line_height()
        if not implot.begin_plot("##times", (-1, height), flags):
            return
        quiet = implot.AxisFlags_.no_tick_labels | implot.AxisFlags_.no_label
        implot.setup_axes("", "ms", quiet, implot.AxisFlags_.no_label)
        implot.setup_axes_limits(0, FRAMES, 0, top, imgui.Cond_.always)
        implot.setup_legend(implot.Location_.north_west)
        for name, history in (("CPU", cpu), ("GPU", gpu)):
            implot.plot_line(name, np.ascontiguousarray(history.total))
        implot.end_plot()

    def _counters(self, imgui: Any, viewer: "Viewer") -> None:
        counts = dict(viewer.renderer.statistics.counts)
        frame = viewer.frame
        if frame is not None and frame.is_done:
            counters = frame.wait()
            for name in counters.__struct_fields__:
                counts[name] = getattr(counters, name)
        if not _begin_table(imgui, "counters", "of the last frame", "count"):
            return
        for name, value in counts.items():
            imgui.table_next_row()
            imgui.table_next_column()
            imgui.text_disabled(name.replace("_", " "))
            imgui.table_next_column()
            imgui.text(f"{value:,}")
        imgui.end_table()


def _begin_table(imgui: Any, name: str, *columns: str) -> bool:
    """Begin one of a wide column of words and a narrow one of numbers."""
    if not imgui.begin_table(name, len(columns)):
        return False
    stretch = imgui.TableColumnFlags_.width_stretch
    for column, weight in zip(columns, (0.7, 0.3), strict=True):
        imgui.table_setup_column(column, stretch, weight)
    imgui.table_headers_row()
    return True


def _table(imgui: Any, title: str, history: History) -> None:
    """Means of the last frames."""
    if not _begin_table(imgui, title, title, "mean"):
        return
    rows = [(name, history.mean(name)) for name in history.series]
    for name, value in (*rows, ("all", sum(value for _, value in rows))):
        imgui.table_next_row()
        imgui.table_next_column()
        imgui.text(name)
        imgui.table_next_column()
        imgui.text(f"{value:.2f}")
    imgui.end_table()
