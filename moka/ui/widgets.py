"""Widgets of the panels: a name, a value, and what a person makes of it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

__all__ = ["choice", "file_items", "hint", "slider"]


def choice(imgui: Any, name: str, value: str, values: Sequence[str]) -> str:
    """One of ``values``, from a list that opens."""
    at = values.index(value) if value in values else -1
    changed, chosen = imgui.combo(name, at, list(values))
    return values[chosen] if changed else value


def slider(
    imgui: Any,
    name: str,
    value: float,
    least: float,
    most: float,
    text: str = "%.3f",
    *,
    logarithmic: bool = False,
) -> float:
    """A number between two; Ctrl and a click type it, also beyond them."""
    flags = imgui.SliderFlags_.logarithmic if logarithmic else 0
    changed, number = imgui.slider_float(name, value, least, most, text, flags)
    return float(number) if changed else value


def hint(imgui: Any, text: str) -> None:
    """Say more of the last widget while the pointer is on it."""
    # At once: after a delay there might be no frame to show it in.
    is_pointed_at = imgui.is_item_hovered(
        imgui.HoveredFlags_.allow_when_disabled
    )
    if is_pointed_at and imgui.begin_tooltip():
        imgui.push_text_wrap_pos(24 * imgui.get_font_size())
        imgui.text(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def file_items(imgui: Any, now: str, files: Sequence[str]) -> str | None:
    """Files in a list that is open, by their last names; what is chosen.

    The whole path of the one under the pointer is told.
    """
    wanted = None
    if files:
        imgui.separator_text("opened before")
    for number, file in enumerate(files):
        imgui.push_id(number)
        if imgui.selectable(Path(file).name, file == now)[0]:
            wanted = file
        if imgui.is_item_hovered():
            imgui.set_tooltip(file)
        imgui.pop_id()
    return wanted
