"""Where the panels of the viewer stand, and what is drawn over the picture."""

from typing import TYPE_CHECKING, Any

from moka.ui.panels.help import draw_help
from moka.ui.panels.timeline import draw_timeline
from moka.ui.selection import draw_box

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["column_width", "draw_interface"]

_COLUMN = 300.0

_WRONG = (1.0, 0.5, 0.4, 1.0)


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
    bottom = float(size[1])
    if viewer.shows_panels:
        _draw_column(viewer, imgui, size)
        bottom -= draw_timeline(imgui, viewer, viewer.area)
    viewer.shows_help = draw_help(imgui, is_open=viewer.shows_help)
    _draw_state(viewer, imgui, bottom)


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
    imgui.text_disabled("F1 lists the keys")
    imgui.end()


def _draw_state(viewer: "Viewer", imgui: Any, bottom: float) -> None:
    """What is being done, and what went wrong, at the lower left."""
    doing = viewer.work.doing
    told = viewer.message if doing is None else f"{doing} ..."
    plain = imgui.get_style().color_(imgui.Col_.text)
    lines = [
        (text, colour)
        for text, colour in ((told, plain), (viewer.error, _WRONG))
        if text is not None
    ]
    if not lines:
        return
    # Measured, since a window that fits itself is cut off for a frame, and
    # there may be no other one.
    wrap = 0.8 * viewer.area[0]
    sizes = [imgui.calc_text_size(text, False, wrap) for text, _ in lines]
    heights = [size.y for size in sizes]
    if viewer.error is not None:
        heights.append(imgui.get_text_line_height())
    style = imgui.get_style()
    padding, gap = style.window_padding, style.item_spacing.y
    imgui.set_next_window_size(
        (
            max(size.x for size in sizes) + 2 * padding.x + 1,
            sum(heights) + gap * (len(heights) - 1) + 2 * padding.y,
        )
    )
    imgui.set_next_window_pos((8, bottom - 8), pivot=(0, 1))
    flags = imgui.WindowFlags_
    imgui.begin("state", None, flags.no_decoration | flags.no_move)
    for text, colour in lines:
        imgui.push_style_color(imgui.Col_.text, colour)
        imgui.push_text_wrap_pos(wrap + padding.x)
        imgui.text(text)
        imgui.pop_text_wrap_pos()
        imgui.pop_style_color()
    if viewer.error is not None and imgui.small_button("dismiss"):
        viewer.error = None
    imgui.end()
