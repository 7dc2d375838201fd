"""Light that is made in the background before a picture needs it.

For a new environment, another mode of lighting, or a picture beside this
one. Until it is there the window shows what it did.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from moka.renderer.light_sources import MadeLighting
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from moka.ui.comparison import COMPARISONS

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["LIGHT_SETTINGS", "PreparedLight", "adopt_light", "prepare_light"]

#: The settings with which the maps of an environment are others.
LIGHT_SETTINGS = frozenset(("ibl", "suns", "irradiance", "reflections"))

PreparedLight = list[tuple[Renderer, MadeLighting]]


def prepare_light(
    viewer: "Viewer",
    environment: Any,
    settings: RenderSettings,
    beside: str | None,
    told: Callable[[str], None],
) -> PreparedLight:
    """What lights the viewer's pictures, unless it is there already.

    On a thread that may wait. ``settings`` and ``beside``, of COMPARISONS,
    are those that will be; ``told`` is told how far it is.
    """
    pictures = [(viewer.renderer, settings)]
    other = viewer.comparison.renderer
    if beside is not None and other is not None:
        pictures.append((other, replace(settings, **COMPARISONS[beside])))
    prepared = []
    for renderer, its in pictures:
        made = renderer.prepare_lighting(
            environment,
            viewer.scene,
            its,
            lambda done, total: told(f"{100 * done // total} %"),
        )
        if made is not None:
            prepared.append((renderer, made))
    return prepared


def adopt_light(prepared: PreparedLight) -> None:
    """Light with it in the next frame."""
    for renderer, made in prepared:
        renderer.adopt_lighting(made)
