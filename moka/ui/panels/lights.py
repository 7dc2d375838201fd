"""The lights of the file, and one that a person adds."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from moka.model.lights import LightKind, PunctualLight
from moka.ui.panels.panel import Panel
from moka.ui.widgets import slider

if TYPE_CHECKING:
    from moka.scene.lights import Light
    from moka.ui.viewer import Viewer

__all__ = ["LightsPanel"]

# In lux or candela, on a logarithmic scale.
_BRIGHTEST = 1e5

_UNITS = {
    LightKind.DIRECTIONAL: "%.3g lx",
    LightKind.POINT: "%.3g cd",
    LightKind.SPOT: "%.3g cd",
}


class LightsPanel(Panel):
    """Puts lights out, changes them, and adds a directional one."""

    title = "Lights"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        lights = viewer.scene.lights
        for number, light in enumerate(lights):
            imgui.push_id(number)
            self._light(imgui, viewer, light, number)
            imgui.pop_id()
        if not lights:
            imgui.text_disabled("no lights but the environment")
        if imgui.button("add a directional light"):
            light = viewer.scene.add_light(
                PunctualLight(LightKind.DIRECTIONAL, intensity=3.0)
            )
            viewer.added_lights.append(light)
            _point(light, math.radians(30.0), math.radians(50.0))
            viewer.request_redraw()

    def _light(
        self, imgui: Any, viewer: "Viewer", light: "Light", number: int
    ) -> None:
        now = light.description
        name = now.name or f"{now.kind.value} light {number}"
        _, visible = imgui.checkbox(name, light.visible)
        if visible != light.visible:
            light.visible = visible
            self._note(viewer, light)
        if not light.visible:
            return
        intensity = slider(
            imgui,
            "intensity",
            now.intensity,
            0.0,
            _BRIGHTEST,
            _UNITS[now.kind],
            logarithmic=True,
        )
        changed, colour = imgui.color_edit3(
            "colour",
            list(now.colour),
            imgui.ColorEditFlags_.float | imgui.ColorEditFlags_.hdr,
        )
        if changed or intensity != now.intensity:
            red, green, blue = (max(each, 0.0) for each in colour)
            light.description = replace(
                now,
                intensity=max(intensity, 0.0),
                colour=(red, green, blue) if changed else now.colour,
            )
            self._note(viewer, light)
        if light not in viewer.added_lights:
            return
        azimuth, elevation = _direction(light)
        turned = slider(imgui, "azimuth", azimuth, -180.0, 180.0, "%.0f°")
        raised = slider(imgui, "elevation", elevation, -90.0, 90.0, "%.0f°")
        if (turned, raised) != (azimuth, elevation):
            _point(light, math.radians(turned), math.radians(raised))
            viewer.request_redraw()
        if imgui.button("remove"):
            viewer.added_lights.remove(light)
            viewer.scene.remove(light)
            viewer.request_redraw()

    def _note(self, viewer: "Viewer", light: "Light") -> None:
        """Something about it has changed."""
        if light not in viewer.added_lights:
            viewer.edits.add("edited lights")
        viewer.request_redraw()


def _point(light: "Light", azimuth: float, elevation: float) -> None:
    """Let it shine from there: from +Z, turned towards +X, raised to +Y."""
    elevation = min(max(elevation, -0.5 * math.pi), 0.5 * math.pi)
    across = math.cos(elevation)
    world = np.eye(4)
    back = np.array(
        [
            across * math.sin(azimuth),
            math.sin(elevation),
            across * math.cos(azimuth),
        ]
    )
    right = np.array([math.cos(azimuth), 0.0, -math.sin(azimuth)])
    world[:3, :3] = np.column_stack([right, np.cross(back, right), back])
    light.transform.world_matrix = world


def _direction(light: "Light") -> tuple[float, float]:
    """Azimuth and elevation from where it shines, in degrees."""
    right, _, back = light.transform.world_matrix[:3, :3].T
    # Of the axis across, which is there straight up and down too.
    azimuth = math.atan2(-right[2], right[0])
    elevation = math.asin(min(max(float(back[1]), -1.0), 1.0))
    return math.degrees(azimuth), math.degrees(elevation)
