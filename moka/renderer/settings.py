"""How a picture is made: the choices of the command line as one value."""

from typing import TYPE_CHECKING

from msgspec import Struct

from moka.core.errors import OptionError

if TYPE_CHECKING:
    from moka.renderer.texture_settings import TextureSettings

__all__ = [
    "BRDFS",
    "DIFFUSE_MODELS",
    "IBL_MODES",
    "TONE_MAPS",
    "RenderSettings",
]

# Those of moka.core.tone_map, which an option should not have to import.
TONE_MAPS = ("neutral", "aces", "agx", "reinhard", "exponential", "none")

BRDFS = ("gltf", "karis", "blinn-phong")
DIFFUSE_MODELS = ("lambert", "oren-nayar", "burley")
IRRADIANCE = ("auto", "sh", "cube")
MIP_FILTERS = ("linear", "nearest")
SHADINGS = ("auto", "forward", "visibility")
REFLECTIONS = ("full", "half")

# Each is a light in every pixel.
MOST_SUNS = 64
LIGHT_PARTS = ("all", "diffuse", "specular", "irradiance")
IBL_MODES = ("split-sum", "filtered", "reference", "off")

DEFAULT_IBL_SAMPLES = 16
# Filtered samples are a loop in one frame; 256 leave nothing to be seen.
MOST_IBL_SAMPLES = 256
MOST_REFERENCE_SAMPLES = 1 << 24

MOST_GAMMA = 10

# As far as any driver goes.
MOST_ANISOTROPY = 16
MOST_TEXTURE_SIZE = 1 << 16


class RenderSettings(Struct, frozen=True):
    """Settings of a :class:`moka.Renderer`.

    ``exposure`` is in stops and applies before the tone map, never to float
    output; ``gamma`` encodes the display with the power 1 / gamma in the
    place of the sRGB curve. ``samples`` is the number of samples per pixel
    for edges; a driver that has fewer uses what it has. ``float_output``
    asks for a float32 target, so that radiance above 65 504 survives into an
    EXR.

    ``suns`` is how many bright, compact parts of the environment become
    lights: ``auto``, ``off`` or a number at most. ``irradiance`` is what
    diffuse light is read from: spherical harmonics (``sh``), a ``cube`` map,
    or ``auto``, which decides by the error of the former. ``reflections`` is
    how large the prefiltered cube is: ``full``, as fine as the environment's
    map, or ``half`` of that along an edge, which is made in a third to a half
    of the time and shows mirrors half as sharp.

    ``ibl`` is how the environment lights: ``off``, not at all, though it is
    seen behind the scene; ``split-sum``; ``filtered``, which
    adds ``ibl_samples`` view-dependent samples; ``reference``, which
    integrates it over several frames until each pixel has
    ``reference_samples`` samples (by default 1024, or 16384 where an error
    decides) or, tile by tile, its estimated relative standard error is below
    ``max_error``. There ``samples`` does not matter: every frame sees
    another point of each pixel.

    ``anisotropy`` is the most samples that a texture seen at a grazing angle
    is read with, ``mip_filter`` whether its two nearest levels are mixed
    (``linear``) or one is read (``nearest``), ``max_texture_size`` how many
    texels a side of a texture keeps; larger ones are reduced, as they are to
    what the driver takes. ``specular_aa`` makes a surface as rough as the
    bumps of its normal map that a pixel averages.

    ``shading`` is when surfaces are shaded: as they are drawn (``forward``),
    or once for each pixel when it is known what is seen (``visibility``,
    where the scene allows it); ``auto`` decides by the driver and the number
    of triangles.
    """

    exposure: float = 0.0
    tone_map: str = "neutral"
    gamma: float | None = None
    samples: int = 4
    brdf: str = "gltf"
    diffuse: str = "lambert"
    multiscatter: bool = True
    float_output: bool = False
    suns: str | int = "auto"
    irradiance: str = "auto"
    reflections: str = "full"
    ibl: str = "split-sum"
    ibl_samples: int = DEFAULT_IBL_SAMPLES
    reference_samples: int | None = None
    max_error: float | None = None
    light_part: str = "all"
    anisotropy: int = 1
    max_texture_size: int | None = None
    specular_aa: bool = False
    mip_filter: str = "linear"
    cull_pixels: float = 0.5
    shading: str = "auto"

    def __post_init__(self) -> None:
        """Raise OptionError for a value that means nothing."""
        _check("tone map", self.tone_map, TONE_MAPS)
        _check("BRDF", self.brdf, BRDFS)
        _check("diffuse model", self.diffuse, DIFFUSE_MODELS)
        _check("irradiance", self.irradiance, IRRADIANCE)
        _check("reflections", self.reflections, REFLECTIONS)
        if self.suns not in ("auto", "off") and not (
            isinstance(self.suns, int) and 0 <= self.suns <= MOST_SUNS
        ):
            raise OptionError(
                f"suns: {self.suns!r} is neither auto, off nor 0 to {MOST_SUNS}"
            )
        _check("lighting mode", self.ibl, IBL_MODES)
        _check("part of the light", self.light_part, LIGHT_PARTS)
        _check_count("filtered samples", self.ibl_samples, MOST_IBL_SAMPLES)
        _check_count(
            "reference samples", self.sample_budget, MOST_REFERENCE_SAMPLES
        )
        _check("shading", self.shading, SHADINGS)
        _check("mip filter", self.mip_filter, MIP_FILTERS)
        _check_count("anisotropy", self.anisotropy, MOST_ANISOTROPY)
        if self.max_texture_size is not None:
            _check_count(
                "texture size", self.max_texture_size, MOST_TEXTURE_SIZE
            )
        if self.max_error is not None and not 0 < self.max_error < 1:
            raise OptionError(
                f"maximum error: {self.max_error} is not between 0 and 1"
            )
        if not 1 <= self.samples <= 64:
            raise OptionError(
                f"samples: {self.samples} is not between 1 and 64"
            )
        if not 0 <= self.cull_pixels <= 1e6:
            raise OptionError(
                f"cull pixels: {self.cull_pixels} is not between 0 and 1e6"
            )
        if self.gamma is not None and not 0 < self.gamma <= MOST_GAMMA:
            raise OptionError(
                f"gamma: {self.gamma} is not above 0 and up to {MOST_GAMMA}"
            )
        if not abs(self.exposure) <= 64:
            raise OptionError(
                f"exposure: {self.exposure} EV is not between -64 and 64"
            )

    @property
    def textures(self) -> "TextureSettings":
        """The part that is about textures."""
        from moka.renderer.texture_settings import TextureSettings

        return TextureSettings(
            self.anisotropy,
            self.max_texture_size,
            self.specular_aa,
            self.mip_filter,
        )

    @property
    def accumulates(self) -> bool:
        """Whether a picture is the mean of several frames."""
        return self.ibl == "reference"

    @property
    def has_float_target(self) -> bool:
        """Whether radiance is drawn as float32, not as half floats."""
        return self.float_output or self.accumulates

    @property
    def sample_budget(self) -> int:
        """Samples of a pixel after which reference lighting stops."""
        if self.reference_samples is not None:
            return self.reference_samples
        return 1024 if self.max_error is None else 16384


def _check(what: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise OptionError(
            f"{what}: {value!r} is unknown; choose from {', '.join(known)}"
        )


def _check_count(what: str, value: int, most: int) -> None:
    if not 1 <= value <= most:
        raise OptionError(f"{what}: {value} is not between 1 and {most}")
