"""Where the panels of the viewer stand, and what is drawn over the picture."""

from typing import TYPE_CHECKING, Any

from moka.ui.panels.help import draw_help
from moka.ui.panels.timeline import draw_timeline
from moka.ui.selection import draw_box

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["column_width", "draw_interface"]

_COLUMN = 300.0


def column_width(width: int, scale: float) -> int:
    """What the panels take of a window of ``width``; ``scale`` is that of text.

    In the window's coordinates; half of a small window at most.
    """
    return min(round(_COLUMN * scale), width // 2)


def draw_interface(viewer: "Viewer", imgui: Any, size: tuple[int, int]) -> None:
    """Say what there is to see in a window of ``size``."""
    box = viewer.selected_bounds
    if box is not None:
        draw_box(imgui, box, viewer.camera, viewer.area)
    if viewer.debug_view is None:
        here = f"{viewer.settings.ibl}, {viewer.settings.brdf}"
        viewer.comparison.draw_divider(imgui, viewer.area, here)
    if viewer.shows_panels:
        _draw_column(viewer, imgui, size)
        draw_timeline(imgui, viewer, viewer.area)
    viewer.shows_help = draw_help(imgui, is_open=viewer.shows_help)
    _draw_state(viewer, imgui, size)


def _draw_column(viewer: "Viewer", imgui: Any, size: tuple[int, int]) -> None:
    width = viewer.column_width
    imgui.set_next_window_pos((size[0] - width, 0))
    imgui.set_next_window_size((width, size[1]))
    flags = imgui.WindowFlags_
    imgui.begin("moka", None, flags.no_decoration | flags.no_move)
    imgui.push_item_width(-0.35 * width)
    for panel in viewer.panels:
        if not panel.is_useful(viewer):
            continue
        opened = imgui.TreeNodeFlags_.default_open if panel.starts_open else 0
        panel.is_open = imgui.collapsing_header(panel.title, opened)
        if panel.is_open:
            imgui.push_id(panel.title)
            panel.draw(imgui, viewer)
            imgui.pop_id()
    imgui.pop_item_width()
    imgui.end()


def _draw_state(viewer: "Viewer", imgui: Any, size: tuple[int, int]) -> None:
    """What is being done, and what went wrong, at the lower left."""
    doing = viewer.work.doing
    if doing is None and viewer.error is None and viewer.message is None:
        return
    imgui.set_next_window_pos((8, size[1] - 8), pivot=(0, 1))
    flags = imgui.WindowFlags_
    imgui.begin(
        "state",
        None,
        flags.no_decoration | flags.always_auto_resize | flags.no_move,
    )
    if doing is not None:
        imgui.text(f"{doing} ...")
    elif viewer.message is not None:
        imgui.text(viewer.message)
    if viewer.error is not None:
        imgui.push_text_wrap_pos(0.6 * size[0])
        imgui.text_colored((1.0, 0.5, 0.4, 1.0), viewer.error)
        imgui.pop_text_wrap_pos()
        if imgui.small_button("dismiss"):
            viewer.error = None
    imgui.end()
