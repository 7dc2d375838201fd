"""How a picture is made: the choices of the command line as one value."""

from dataclasses import dataclass

from moka.core.errors import OptionError

__all__ = ["BRDFS", "DIFFUSE_MODELS", "RenderSettings"]

BRDFS = ("gltf", "karis", "blinn-phong")
DIFFUSE_MODELS = ("lambert", "oren-nayar", "burley")
IRRADIANCE = ("auto", "sh", "cube")

# Each is a light in every pixel.
MOST_SUNS = 64


@dataclass(frozen=True, slots=True)
class RenderSettings:
    """Settings of a :class:`moka.Renderer`.

    ``exposure`` is in stops and applies before the tone map, never to float
    output. ``samples`` is the number of samples per pixel for edges; a
    driver that has fewer uses what it has. ``float_output`` asks for a
    float32 target, so that radiance above 65 504 survives into an EXR.

    ``suns`` is how many bright, compact parts of the environment become
    lights: ``auto``, ``off`` or a number at most. ``irradiance`` is what
    diffuse light is read from: spherical harmonics (``sh``), a ``cube`` map,
    or ``auto``, which decides by the error of the former.
    """

    exposure: float = 0.0
    tone_map: str = "neutral"
    samples: int = 4
    brdf: str = "gltf"
    diffuse: str = "lambert"
    multiscatter: bool = True
    float_output: bool = False
    suns: str | int = "auto"
    irradiance: str = "auto"

    def __post_init__(self) -> None:
        """Raise OptionError for a value that means nothing."""
        from moka.core.tone_map import TONE_MAPS

        _check("tone map", self.tone_map, tuple(TONE_MAPS))
        _check("BRDF", self.brdf, BRDFS)
        _check("diffuse model", self.diffuse, DIFFUSE_MODELS)
        _check("irradiance", self.irradiance, IRRADIANCE)
        if self.suns not in ("auto", "off") and not (
            isinstance(self.suns, int) and 0 <= self.suns <= MOST_SUNS
        ):
            raise OptionError(
                f"suns: {self.suns!r} is neither auto, off nor 0 to {MOST_SUNS}"
            )
        if not 1 <= self.samples <= 64:
            raise OptionError(
                f"samples: {self.samples} is not between 1 and 64"
            )
        if not abs(self.exposure) <= 64:
            raise OptionError(
                f"exposure: {self.exposure} EV is not between -64 and 64"
            )


def _check(what: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise OptionError(
            f"{what}: {value!r} is unknown; choose from {', '.join(known)}"
        )
