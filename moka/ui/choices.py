"""How the picture is made and what stands beside it, as a person chooses."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from moka.core.errors import OptionError
from moka.renderer.settings import RenderSettings
from moka.ui.light_preparation import (
    LIGHT_SETTINGS,
    PreparedLight,
    adopt_light,
    prepare_light,
)
from moka.ui.preferences import Preferences

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["Choices"]


class Choices:
    """Makes changes to a viewer that a person wants, or says why not."""

    def __init__(self, viewer: "Viewer") -> None:
        self._viewer = viewer

    def change_settings(self, **changes: Any) -> None:
        """Replace settings by name, if they are others than now.

        Those that need other light are replaced when it is there. What
        means nothing, as a person may type it, is told and changes nothing.
        """
        viewer = self._viewer
        now = viewer.settings
        changes = {
            name: value
            for name, value in changes.items()
            if getattr(now, name) != value
        }
        if not changes:
            return
        try:
            wanted = replace(now, **changes)
        except OptionError as error:
            viewer.error = str(error)
            viewer.request_redraw()
            return
        if LIGHT_SETTINGS.isdisjoint(changes):
            viewer.renderer.settings = wanted
            viewer.request_redraw()
            return

        def change() -> None:
            viewer.renderer.settings = replace(viewer.settings, **changes)

        self._light_otherwise(wanted, viewer.comparison.choice, change)

    def compare_with(self, choice: str | None) -> None:
        """Have a picture of COMPARISONS beside this one, or none."""
        viewer = self._viewer

        def change() -> None:
            viewer.comparison.choice = choice

        if choice is None:
            change()
            viewer.request_redraw()
            return
        viewer.comparison.beside(viewer.renderer)
        self._light_otherwise(viewer.settings, choice, change)

    def _light_otherwise(
        self,
        settings: RenderSettings,
        beside: str | None,
        change: Callable[[], None],
    ) -> None:
        """Make a change as soon as there is the light that it needs."""
        viewer = self._viewer

        def told(progress: str) -> None:
            viewer.work.tell(f"preparing the light: {progress}")

        def then(prepared: PreparedLight) -> None:
            adopt_light(prepared)
            change()
            viewer.request_redraw()

        environment = viewer.scene.environment
        viewer.work.start(
            "preparing the light",
            lambda: prepare_light(viewer, environment, settings, beside, told),
            then,
        )
        viewer.request_redraw()

    def remembered(self) -> Preferences:
        """What has been chosen, for the next time."""
        viewer = self._viewer
        settings = viewer.settings
        fills_screen = viewer.window is not None and viewer.window.fullscreen
        return replace(
            viewer.preferences,
            size=viewer.preferences.size
            if fills_screen
            else viewer.window_size,
            shows_panels=viewer.shows_panels,
            open_panels=tuple(
                panel.title for panel in viewer.panels if panel.is_open
            ),
            environment=viewer.files.remembered_environment,
            environment_intensity=viewer.scene.environment_intensity,
            background_blur=viewer.scene.background_blur,
            exposure=settings.exposure,
            tone_map=settings.tone_map,
            gamma=settings.gamma,
            auto_rotates=viewer.auto_rotates,
        )
