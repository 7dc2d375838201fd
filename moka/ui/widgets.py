"""Widgets of the panels: a name, a value, and what a person makes of it."""

from collections.abc import Sequence
from typing import Any

__all__ = ["choice", "slider"]


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
