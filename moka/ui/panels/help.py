"""Keys and gestures, in a window of their own."""

from typing import Any

__all__ = ["draw_help"]

_GESTURES = (
    ("left drag", "orbit"),
    ("right or middle drag", "pan"),
    ("wheel", "zoom to the pointer"),
    ("W A S D, Q E", "fly; Shift is faster"),
    ("click", "select"),
    ("double click", "go around the point under the pointer"),
    ("F", "frame the selection"),
    ("Home", "frame everything"),
    ("C", "next camera of the file"),
    ("R", "turn around by itself"),
    ("Space", "play or pause"),
    ("H or Tab", "hide and show the panels"),
    ("drop a file", "open a model, or light with an environment"),
    ("Ctrl+click on a slider", "type a number"),
    ("F1", "this help"),
    ("F11", "full screen"),
    ("F12", "save the picture"),
    ("Ctrl+C", "copy the moka render command"),
    ("Escape", "close"),
)


def draw_help(imgui: Any, *, is_open: bool) -> bool:
    """Draw it; returns whether it is still wanted."""
    if not is_open:
        return False
    imgui.set_next_window_pos((40, 40), imgui.Cond_.appearing)
    visible, is_open = imgui.begin(
        "Help", True, imgui.WindowFlags_.always_auto_resize
    )
    if visible and imgui.begin_table("gestures", 2):
        for gesture, meaning in _GESTURES:
            imgui.table_next_row()
            imgui.table_next_column()
            imgui.text_disabled(gesture)
            imgui.table_next_column()
            imgui.text(meaning)
        imgui.end_table()
    imgui.end()
    return bool(is_open)
