"""What is seen behind a scene: its environment's map, and suns as discs."""

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.lighting.environment_maps import upload_map
from moka.renderer.light_sources import LightSources
from moka.renderer.sky import Sky
from moka.renderer.view import View
from moka.scene.scene import Scene

__all__ = ["SkyMap"]


class SkyMap:
    """Finds what is behind a scene, and keeps its map without suns.

    Where these are no lights they are a texel or two of the map that lights,
    which would look like squares; behind the scene they are discs.
    """

    def __init__(self, device: GraphicsDevice, sources: LightSources) -> None:
        self._device = device
        self._sources = sources
        self._texture: Handle | None = None

    def behind(
        self, scene: Scene, view: View, height: int, *, float_target: bool
    ) -> Sky | None:
        """What a picture of so many pixels in ``height`` has behind ``scene``.

        None if that is a colour, or nothing. With the maps of the last
        :meth:`LightSources.update_maps`.
        """
        sources = self._sources
        environment_map = sources.maps.map
        if scene.background != "environment" or environment_map is None:
            return None
        cube, suns = None, scene.environment.suns
        if scene.background_blur > 0.0:
            cube, suns = sources.maps.specular, sources.suns
        elif sources.map_shows_suns:
            environment_map = self._without_suns(scene.environment)
        return Sky(
            environment_map,
            view,
            rotation=scene.environment_rotation,
            intensity=scene.environment_intensity,
            float_target=float_target,
            suns=suns,
            height=height,
            cube=cube,
            levels=sources.maps.specular_levels,
            blur=scene.background_blur,
        )

    def _without_suns(self, environment: Environment) -> Handle:
        if self._texture is None:
            self._texture = upload_map(self._device, environment.pixels)
        return self._texture

    def forget(self) -> None:
        """Destroy the texture, which was another environment's."""
        if self._texture is not None:
            self._device.destroy(self._texture)
            self._texture = None
