"""The animation that plays, along the lower edge of the picture."""

from typing import TYPE_CHECKING, Any

from moka.ui.widgets import choice, slider

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["draw_timeline", "toggle_playing"]


def toggle_playing(viewer: "Viewer") -> None:
    """Pause what plays, or play what does not."""
    if viewer.model is None or not viewer.model.model.animations:
        return
    player = viewer.model.animations
    current = player.current
    if current is None or (current.speed == 0.0 or current.has_ended):
        number = 0 if current is None else current.animation
        start = 0.0 if current is None or current.has_ended else current.time
        player.play(number, start=start)
    elif player.paused:
        player.resume()
    else:
        player.pause()
    viewer.request_redraw()


def draw_timeline(imgui: Any, viewer: "Viewer", area: tuple[int, int]) -> None:
    """Draw it over the bottom of ``area``, if the model is animated."""
    if viewer.model is None or not viewer.model.model.animations:
        return
    player = viewer.model.animations
    current = player.current
    margin = 8
    imgui.set_next_window_pos((margin, area[1] - margin), pivot=(0, 1))
    imgui.set_next_window_size((area[0] - 2 * margin, 0))
    flags = imgui.WindowFlags_
    imgui.begin("timeline", None, flags.no_decoration | flags.no_move)
    is_playing = player.is_playing and current is not None and current.speed
    if imgui.button("pause" if is_playing else "play"):
        toggle_playing(viewer)
    imgui.same_line()
    names = [f"{number}: {name}" for number, name in enumerate(player.names)]
    imgui.set_next_item_width(0.25 * area[0])
    shown = names[current.animation] if current else names[0]
    wanted = choice(imgui, "##animation", shown, names)
    if wanted != shown or current is None:
        was_paused = player.paused
        current = player.play(names.index(wanted), fade=0.0)
        if was_paused:
            player.pause()
    imgui.same_line()
    imgui.set_next_item_width(0.12 * area[0])
    current.speed = slider(imgui, "speed", current.speed, -2, 2, "%.2f")
    imgui.same_line()
    _, current.loop = imgui.checkbox("loop", current.loop)
    imgui.same_line()
    imgui.set_next_item_width(-1)
    time = slider(
        imgui, "##time", current.time, 0.0, current.duration, "%.2f s"
    )
    if time != current.time:
        player.seek(time)
        viewer.request_redraw()
    imgui.end()
