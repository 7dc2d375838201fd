"""The panel of the nodes, with many of them."""

import time
from collections import defaultdict
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from moka.app.events import MouseButtonEvent, MouseMoveEvent
from moka.app.keys import Modifiers, MouseButton
from moka.graphics.device import GraphicsDevice
from moka.ui.interface import Interface
from moka.ui.panels.scene_tree import SceneTreePanel

pytest.importorskip("imgui_bundle")
pytestmark = pytest.mark.gpu

SIZE = (300, 500)


@pytest.fixture
def interface() -> Iterator[Interface]:
    with GraphicsDevice.open("egl", debug=True) as device:
        made = Interface(device)
        yield made
        made.close()


def viewer_of(parents: Any) -> Any:
    """As much of a viewer as the panel looks at."""
    count = len(parents)
    nodes = SimpleNamespace(
        parents=np.asarray(parents),
        names=[f"part {row}" if row % 2 else "" for row in range(count)],
        source=np.arange(count),
    )
    handles: Any = defaultdict(lambda: SimpleNamespace(visible=True))
    return SimpleNamespace(
        model=SimpleNamespace(
            model=SimpleNamespace(nodes=nodes), node=lambda row: handles[row]
        ),
        handles=handles,
        selection=None,
        edits=set(),
        request_redraw=lambda: None,
    )


def draw(interface: Interface, panel: SceneTreePanel, viewer: Any) -> None:
    with interface.frame(SIZE, 0.1) as imgui:
        imgui.set_next_window_pos((0, 0))
        imgui.set_next_window_size(SIZE)
        imgui.begin("panel", None, imgui.WindowFlags_.no_decoration)
        panel.draw(imgui, viewer)
        imgui.end()


def click(
    interface: Interface, panel: SceneTreePanel, viewer: Any, x: int, y: int
) -> None:
    draw(interface, panel, viewer)
    interface.take(MouseMoveEvent(x, y, 0, 0))
    draw(interface, panel, viewer)
    for pressed in (True, False):
        button = MouseButton.LEFT
        interface.take(MouseButtonEvent(button, pressed, x, y, Modifiers.NONE))
        draw(interface, panel, viewer)


def test_only_the_rows_that_are_seen_are_drawn(interface: Interface) -> None:
    """All of a hundred thousand nodes are open, and a frame is short."""
    count = 100_000
    viewer, panel = viewer_of((np.arange(count) - 1) // 10), SceneTreePanel()
    draw(interface, panel, viewer)
    assert len(viewer.handles) == 1  # The root is closed.
    for row in range(count // 10):
        panel._rows.toggle(row)
    draw(interface, panel, viewer)
    draw(interface, panel, viewer)
    assert 5 < len(viewer.handles) < 40
    start = time.perf_counter()
    for _ in range(20):
        draw(interface, panel, viewer)
    assert (time.perf_counter() - start) / 20 < 0.03
    # The last one is scrolled to.
    viewer.selection = count - 1
    draw(interface, panel, viewer)
    viewer.handles.clear()
    draw(interface, panel, viewer)
    draw(interface, panel, viewer)
    assert count - 1 in viewer.handles


def test_clicks_hide_open_and_select(interface: Interface) -> None:
    viewer = viewer_of([-1, *[0] * 30])
    panel = SceneTreePanel()
    # Below the search: the first row's box, arrow and name.
    click(interface, panel, viewer, 18, 42)
    assert not viewer.handles[0].visible
    assert len(panel._rows.seen) == 1
    click(interface, panel, viewer, 46, 42)
    assert len(panel._rows.seen) == 31
    click(interface, panel, viewer, 80, 65)
    assert viewer.selection == 1
