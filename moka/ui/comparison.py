"""Two pictures in one window: the viewer's, and beside it one made otherwise.

The other one has a renderer of its own for its settings, lights and targets.
Programs, geometry and textures are those of the viewer's, so that it costs
the memory of a picture and of what lights it, and only while it is there.
Each of the two draws what is on its side of the divider.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from msgspec.structs import replace

from moka.commands.command_list import CommandList
from moka.commands.commands import Timestamps
from moka.renderer.renderer import Renderer
from moka.scene.camera import Camera
from moka.scene.scene import Scene
from moka.ui.frame_times import mark_passes

__all__ = ["COMPARISONS", "Comparison"]

#: What a picture may be compared with: the settings that are others there.
COMPARISONS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "reference lighting": {"ibl": "reference"},
        "filtered lighting": {"ibl": "filtered"},
        "split-sum lighting": {"ibl": "split-sum"},
        "no light of the environment": {"ibl": "off"},
        "suns left in the map": {"suns": "off", "ibl": "split-sum"},
        "single scattering": {"multiscatter": False},
        "BRDF gltf": {"brdf": "gltf"},
        "BRDF karis": {"brdf": "karis"},
        "BRDF blinn-phong": {"brdf": "blinn-phong"},
        "diffuse lambert": {"diffuse": "lambert"},
        "diffuse oren-nayar": {"diffuse": "oren-nayar"},
        "diffuse burley": {"diffuse": "burley"},
        "diffuse light": {"light_part": "diffuse"},
        "specular light": {"light_part": "specular"},
        "no multisampling": {"samples": 1},
    }
)

# How far from the divider, in the window's coordinates, it can be taken.
_REACH = 6.0

# That much of the picture stays on either side.
_MARGIN = 0.02

_LINE = 0xE0FFFFFF
_SHADOW = 0xA0000000


class Comparison:
    """What stands beside the picture: ``choice`` of COMPARISONS, or None.

    ``divider`` is where the other one begins, as a part of the picture's
    width from the left. ``renderer`` makes it, once there has been one.
    """

    def __init__(self) -> None:
        self.choice: str | None = None
        self.divider = 0.5
        self.is_dragged = False
        self.renderer: Renderer | None = None

    @property
    def is_complete(self) -> bool:
        """Whether another frame would show the same."""
        return (
            self.choice is None
            or self.renderer is None
            or self.renderer.is_complete
        )

    def take(self, x: float, width: float) -> bool:
        """Take the divider if it is at ``x`` of ``width``; whether it is."""
        reached = abs(x - self.divider * width) <= _REACH
        self.is_dragged = self.choice is not None and reached
        return self.is_dragged

    def drag(self, x: float, width: float) -> None:
        """Move the divider to ``x`` of ``width``."""
        self.divider = min(max(x / width, _MARGIN), 1.0 - _MARGIN)

    def beside(self, main: Renderer) -> Renderer:
        """The renderer of the other picture, made if there is none."""
        if self.renderer is None:
            self.renderer = Renderer(main.device, to_window=True, beside=main)
        return self.renderer

    def draw(
        self,
        main: Renderer,
        scene: Scene,
        camera: Camera,
        times: Timestamps | None = None,
    ) -> None:
        """Submit the other picture, and leave ``main`` its own side.

        To be called before ``main`` draws. Into the window, in a frame
        before the one that is presented.
        """
        if self.choice is None:
            main.area = None
            if self.renderer is not None:
                self.renderer.release_targets()
            return
        other = self.beside(main)
        width, height = other.size = main.size
        left = round(self.divider * width)
        main.area = (0, 0, left, height)
        other.area = (left, 0, width - left, height)
        other.settings = replace(main.settings, **COMPARISONS[self.choice])
        commands = CommandList()
        if times is not None:
            mark_passes(commands, times, "beside: ")
        other.draw(scene, camera, commands)
        main.device.submit(commands, paced=False)

    def draw_divider(
        self, imgui: Any, area: tuple[int, int], here: str
    ) -> None:
        """Draw it over a picture that fills ``area``, with both names.

        ``here`` is that of the picture on the left.
        """
        if self.choice is None:
            return
        width, height = area
        x = self.divider * width
        drawn = imgui.get_background_draw_list()
        drawn.push_clip_rect((0, 0), area)
        drawn.add_line((x, 0), (x, height), _SHADOW, 4.0)
        drawn.add_line((x, 0), (x, height), _LINE, 1.5)
        for side in (-1, 1):
            tip, base = x + 11 * side, x + 4 * side
            drawn.add_triangle_filled(
                (tip, height / 2),
                (base, height / 2 + 6 * side),
                (base, height / 2 - 6 * side),
                _LINE,
            )
        gap = imgui.get_text_line_height()
        left = x - gap - imgui.calc_text_size(here).x
        for text, at in ((here, left), (self.choice, x + gap)):
            drawn.add_text((at + 1, gap / 2 + 1), _SHADOW, text)
            drawn.add_text((at, gap / 2), _LINE, text)
        drawn.pop_clip_rect()
