"""What of an environment a picture shows, and so what is made of it."""

from typing import TYPE_CHECKING

from msgspec import Struct

from moka.lighting.environment import AUTO_SUNS, Environment
from moka.lighting.environment_lighting import LightingRequest
from moka.renderer.settings import MOST_SUNS, RenderSettings

if TYPE_CHECKING:
    from moka.scene.scene import Scene

__all__ = ["MapNeeds", "map_needs"]


class MapNeeds(Struct, frozen=True):
    """What of an environment a picture shows.

    ``specular`` and ``irradiance`` are what surfaces reflect; ``suns``,
    ``irradiance_as``, ``ibl`` and ``reflections`` are RenderSettings'
    ``suns``, ``irradiance``, ``ibl`` and ``reflections``. With ``blurred``
    the background is read from the specular cube. Reference lighting samples
    the map as it is, and the environment's own suns as discs.
    """

    background: bool
    specular: bool
    irradiance: bool
    suns: str | int = "auto"
    irradiance_as: str = "auto"
    ibl: str = "split-sum"
    reflections: str = "full"
    blurred: bool = False

    def request(
        self, environment: Environment | None
    ) -> LightingRequest | None:
        """What to make of ``environment``; None for nothing."""
        reflects = self.specular or self.irradiance
        specular = self.specular or self.blurred
        if environment is None or not (self.background or reflects or specular):
            return None
        if self.ibl == "reference" and reflects:
            return LightingRequest(
                environment,
                MOST_SUNS,
                self.irradiance_as,
                background=True,
                specular=self.blurred,
                sampled=True,
                half=self.reflections == "half",
            )
        return LightingRequest(
            environment,
            _most_suns(self.suns),
            self.irradiance_as,
            background=self.background,
            specular=specular,
            irradiance=self.irradiance,
            radiance=self.ibl == "filtered" and specular,
            half=self.reflections == "half",
        )


def map_needs(
    scene: "Scene", settings: RenderSettings, *, is_lit: bool, has_diffuse: bool
) -> MapNeeds:
    """What of an environment ``scene`` shows, whichever it is."""
    shows_irradiance = is_lit and settings.light_part == "irradiance"
    reflects = settings.ibl != "off"
    has_background = scene.background == "environment"
    return MapNeeds(
        background=has_background,
        specular=is_lit and reflects,
        irradiance=(has_diffuse or shows_irradiance) and reflects,
        suns=settings.suns if reflects else "off",
        irradiance_as=settings.irradiance,
        ibl=settings.ibl,
        reflections=settings.reflections,
        blurred=has_background and scene.background_blur > 0.0,
    )


def _most_suns(suns: str | int) -> int:
    if isinstance(suns, int):
        return suns
    return AUTO_SUNS if suns == "auto" else 0
