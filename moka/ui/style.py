"""How panels look: a font that reads well, and colours that stay behind.

Greys are neutral and dark, so that the picture beside them is judged as it
is (ISO 3664 asks for a neutral surround); one colour marks what can be
moved and what is on.
"""

from importlib.resources import files
from typing import Any

__all__ = ["apply_style"]

_TEXT_SIZE = 15.0

Colour = tuple[float, float, float, float]

_ACCENT: Colour = (0.30, 0.56, 0.84, 1.0)
_ACCENT_LIGHT: Colour = (0.44, 0.68, 0.94, 1.0)
_ACCENT_DIM: Colour = (0.22, 0.36, 0.52, 1.0)
# So that the number in the middle of a slider is read through its grip.
_GRIP: Colour = (0.30, 0.56, 0.84, 0.60)
_GRIP_HELD: Colour = (0.44, 0.68, 0.94, 0.75)

_COLOURS: dict[str, Colour] = {
    "text": (0.90, 0.90, 0.90, 1.0),
    "text_disabled": (0.58, 0.58, 0.58, 1.0),
    "window_bg": (0.13, 0.13, 0.13, 1.0),
    "popup_bg": (0.16, 0.16, 0.16, 1.0),
    "border": (0.30, 0.30, 0.30, 0.60),
    "frame_bg": (0.07, 0.07, 0.07, 1.0),
    "frame_bg_hovered": (0.20, 0.20, 0.20, 1.0),
    "frame_bg_active": (0.24, 0.24, 0.24, 1.0),
    "title_bg": (0.18, 0.18, 0.18, 1.0),
    "title_bg_active": (0.22, 0.22, 0.22, 1.0),
    "check_mark": _ACCENT_LIGHT,
    "slider_grab": _GRIP,
    "slider_grab_active": _GRIP_HELD,
    "button": (0.26, 0.26, 0.26, 1.0),
    "button_hovered": _ACCENT_DIM,
    "button_active": _ACCENT,
    "header": (0.21, 0.21, 0.21, 1.0),
    "header_hovered": _ACCENT_DIM,
    "header_active": _ACCENT,
    "separator": (0.30, 0.30, 0.30, 0.60),
    "table_header_bg": (0.18, 0.18, 0.18, 1.0),
    "plot_histogram": _ACCENT,
    "text_selected_bg": _ACCENT_DIM,
    "nav_cursor": _ACCENT,
}


def apply_style(imgui: Any, scale: float) -> None:
    """Set the style and the font of the current context.

    ``scale`` is by how much a person has text and buttons enlarged.
    """
    style = imgui.get_style()
    for name, colour in _COLOURS.items():
        style.set_color_(getattr(imgui.Col_, name), imgui.ImVec4(*colour))
    style.window_padding = imgui.ImVec2(8, 8)
    style.frame_padding = imgui.ImVec2(6, 3)
    style.item_spacing = imgui.ImVec2(6, 5)
    style.window_rounding = style.popup_rounding = 4.0
    style.frame_rounding = style.grab_rounding = 3.0
    style.scrollbar_size = 12.0
    style.scale_all_sizes(scale)
    style.font_size_base = _TEXT_SIZE
    style.font_scale_dpi = scale
    font = files("imgui_bundle").joinpath("assets/fonts/Roboto")
    regular = font.joinpath("Roboto-Regular.ttf")
    if regular.is_file():
        imgui.get_io().fonts.add_font_from_file_ttf(str(regular), _TEXT_SIZE)
