"""The map that is seen behind a scene."""

from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.lighting.environment_maps import upload_map

__all__ = ["SkyMap"]


class SkyMap:
    """Keeps the map of an environment without its suns.

    Where these are no lights they are a texel or two of the map that lights,
    which would look like squares; behind the scene they are discs.
    """

    def __init__(self, device: GraphicsDevice) -> None:
        self._device = device
        self._texture: Handle | None = None

    def without_suns(self, environment: Environment) -> Handle:
        """The texture of its pixels, which stays until :meth:`forget`."""
        if self._texture is None:
            self._texture = upload_map(self._device, environment.pixels)
        return self._texture

    def forget(self) -> None:
        """Destroy the texture, which was another environment's."""
        if self._texture is not None:
            self._device.destroy(self._texture)
            self._texture = None
