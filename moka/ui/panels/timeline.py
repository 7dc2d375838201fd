"""The animation that plays, along the lower edge of the picture."""

from typing import TYPE_CHECKING, Any

from moka.ui.widgets import choice, slider

if TYPE_CHECKING:
    from moka.scene.animation_player import AnimationPlayer
    from moka.ui.viewer import Viewer

__all__ = ["draw_timeline", "toggle_playing"]


# Heights of text that one line of all widgets takes at least.
_NARROW = 30.0


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


def draw_timeline(imgui: Any, viewer: "Viewer", area: tuple[int, int]) -> float:
    """Draw it over the bottom of ``area``, if the model is animated.

    Returns how much of the height it takes.
    """
    if viewer.model is None or not viewer.model.model.animations:
        return 0.0
    player = viewer.model.animations
    current = player.current
    style = imgui.get_style()
    margin = 8
    imgui.set_next_window_pos((margin, area[1] - margin), pivot=(0, 1))
    imgui.set_next_window_size((area[0] - 2 * margin, 0))
    flags = imgui.WindowFlags_
    imgui.begin("timeline", None, flags.no_decoration | flags.no_move)
    is_playing = player.is_playing and current is not None and current.speed
    # As wide whatever it says, so that nothing else moves.
    width = imgui.calc_text_size("pause").x + 2 * style.frame_padding.x
    if imgui.button("pause" if is_playing else "play", (width, 0)):
        toggle_playing(viewer)
    imgui.same_line()
    is_narrow = area[0] < _NARROW * imgui.get_font_size()
    if is_narrow:
        _draw_time(imgui, viewer, player)
    _draw_choice(imgui, player, area[0])
    if not is_narrow:
        imgui.same_line()
        _draw_time(imgui, viewer, player)
    height = float(imgui.get_window_height())
    imgui.end()
    return height + margin


def _draw_choice(imgui: Any, player: "AnimationPlayer", width: float) -> None:
    """Which animation, how fast, and whether over and over again."""
    current = player.current
    names = [f"{number}: {name}" for number, name in enumerate(player.names)]
    imgui.set_next_item_width(0.25 * width)
    shown = names[current.animation] if current else names[0]
    wanted = choice(imgui, "##animation", shown, names)
    if wanted != shown or current is None:
        was_paused = player.paused
        current = player.play(names.index(wanted), fade=0.0)
        if was_paused:
            player.pause()
    imgui.same_line()
    imgui.set_next_item_width(0.12 * width)
    current.speed = slider(imgui, "speed", current.speed, -2, 2, "%.2f")
    imgui.same_line()
    _, current.loop = imgui.checkbox("loop", current.loop)


def _draw_time(imgui: Any, viewer: "Viewer", player: "AnimationPlayer") -> None:
    current = player.current
    if current is None:
        return
    imgui.set_next_item_width(-1)
    time = slider(
        imgui, "##time", current.time, 0.0, current.duration, "%.2f s"
    )
    if time != current.time:
        player.seek(time)
        viewer.request_redraw()
