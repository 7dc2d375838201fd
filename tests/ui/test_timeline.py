"""The timeline in wide and in narrow windows."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.ui.interface import Interface
from moka.ui.panels.timeline import draw_timeline
from tests.ui.test_interface import shown

pytest.importorskip("imgui_bundle")
pytestmark = pytest.mark.gpu

HEIGHT = 120


def drawn(width: int, *, is_playing: bool = True) -> tuple[np.ndarray, float]:
    """What is drawn (HEIGHT, width, 4), and the height that it takes."""
    current = SimpleNamespace(
        animation=0, time=0.5, duration=2.0, speed=1.0, loop=True
    )
    player = SimpleNamespace(
        current=current, names=["Idle"], is_playing=is_playing, paused=False
    )
    model = SimpleNamespace(animations=player)
    model.model = SimpleNamespace(animations=[object()])
    viewer: Any = SimpleNamespace(model=model)
    with GraphicsDevice.open("egl", debug=True) as device:
        interface = Interface(device)
        for _ in range(3):  # A window that fits itself needs a few.
            with interface.frame((width, HEIGHT), 0.1) as imgui:
                taken = draw_timeline(imgui, viewer, (width, HEIGHT))
        pixels = shown(device, interface, (width, HEIGHT))
        interface.close()
    return pixels, taken


@pytest.mark.parametrize("width", [200, 320, 900])
def test_it_stands_along_the_lower_edge_and_says_how_high(width: int) -> None:
    pixels, taken = drawn(width)
    rows, columns = np.nonzero((pixels != (51, 51, 51, 255)).any(axis=2))
    assert rows.min() == HEIGHT - taken
    assert rows.max() == HEIGHT - 8 - 1
    assert columns.min() == 8
    assert columns.max() == width - 8 - 1


def test_a_narrow_one_has_two_lines() -> None:
    wide, narrow = drawn(900)[1], drawn(240)[1]
    assert narrow > wide + 15
    # Of which the first is the time's: its grip is a quarter of the way.
    pixels, taken = drawn(240)
    top = int(HEIGHT - taken)
    line = pixels[top + 18, 8:232, :3].astype(int)
    is_blue = line[:, 2] > line[:, 0] + 40
    assert 60 < np.flatnonzero(is_blue).mean() < 120


def test_nothing_moves_when_it_is_paused() -> None:
    playing, paused = drawn(900)[0], drawn(900, is_playing=False)[0]
    changed = np.nonzero((playing != paused).any(axis=2))[1]
    assert changed.min() > 16
    assert changed.max() < 70
