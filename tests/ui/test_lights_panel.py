"""Where a light shines from, and the angles that a panel shows of it."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from moka.app.events import MouseButtonEvent, MouseMoveEvent
from moka.app.keys import Modifiers, MouseButton
from moka.graphics.device import GraphicsDevice
from moka.model.lights import LightKind, PunctualLight
from moka.scene.scene import Scene
from moka.ui.interface import Interface
from moka.ui.panels.lights import LightsPanel, _direction, _point


@pytest.mark.parametrize("azimuth", [-170.0, -90.0, 0.0, 30.0, 179.0])
@pytest.mark.parametrize("elevation", [-90.0, -20.0, 0.0, 50.0, 90.0])
def test_angles_are_kept_also_straight_up_and_down(
    azimuth: float, elevation: float
) -> None:
    scene = Scene()
    light = scene.add_light(PunctualLight(LightKind.DIRECTIONAL))
    _point(light, math.radians(azimuth), math.radians(elevation))
    assert _direction(light) == pytest.approx((azimuth, elevation), abs=1e-6)
    scene.update()
    (row,) = scene.light_rows()
    across = math.cos(math.radians(elevation))
    towards = (
        across * math.sin(math.radians(azimuth)),
        math.sin(math.radians(elevation)),
        across * math.cos(math.radians(azimuth)),
    )
    np.testing.assert_allclose(-row["direction"], towards, atol=1e-6)


@pytest.mark.gpu
def test_clicks_add_a_light_put_it_out_and_take_it_away() -> None:
    pytest.importorskip("imgui_bundle")
    scene, panel = Scene(), LightsPanel()
    viewer: Any = SimpleNamespace(
        scene=scene, added_lights=[], request_redraw=lambda: None
    )

    def draw(interface: Interface) -> list[tuple[float, float]]:
        """Where each row begins."""
        with interface.frame((300, 400), 0.1) as imgui:
            imgui.set_next_window_pos((0, 0))
            imgui.set_next_window_size((300, 400))
            imgui.begin("panel", None, imgui.WindowFlags_.no_decoration)
            panel.draw(imgui, viewer)
            end = imgui.get_cursor_pos().y
            imgui.end()
        return [(20.0, end - 35), (20.0, end - 12)]

    def click(interface: Interface, x: float, y: float) -> None:
        interface.take(MouseMoveEvent(x, y, 0, 0))
        draw(interface)
        for pressed in (True, False):
            button = MouseButton.LEFT
            interface.take(
                MouseButtonEvent(button, pressed, x, y, Modifiers.NONE)
            )
            draw(interface)

    with GraphicsDevice.open("egl", debug=True) as device:
        interface = Interface(device)
        draw(interface)
        click(interface, *draw(interface)[1])  # The last row adds one.
        (light,) = scene.lights
        scene.update()
        assert scene.light_rows()["intensity"].max() == 3.0
        click(interface, 18, 18)
        assert not light.visible
        assert not len(scene.light_rows())
        click(interface, 18, 18)
        assert light.visible
        click(interface, *draw(interface)[0])  # The one before it removes.
        assert scene.lights == viewer.added_lights == []
        interface.close()
