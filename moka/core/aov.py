"""Arbitrary output variables: what a picture can tell besides its colour."""

from collections.abc import Iterable
from typing import NamedTuple

from moka.core.errors import OptionError

__all__ = ["AOVS", "Aov", "exr_layer", "parse_aovs"]


class Aov(NamedTuple):
    """One of them: ``letters`` are its channels in an EXR file, if several.

    ``dtype`` is NumPy's name of its type, ``nothing`` its value where no
    surface is, ``summary`` what it means and in which unit.
    """

    letters: str
    summary: str
    dtype: str = "float32"
    nothing: float = 0.0


#: By name. All of them are those of the nearest surface at the centre of a
#: pixel, never averages of several: half of two depths is no depth.
AOVS = {
    "depth": Aov(
        "",
        "distance along the view axis in metres, +inf where nothing is",
        nothing=float("inf"),
    ),
    "normal": Aov("XYZ", "shading normal in world space, unit length"),
    "albedo": Aov("RGB", "base colour, linear Rec.709"),
    "roughness": Aov("", "perceptual roughness, 0 to 1"),
    "metallic": Aov("", "metalness, 0 to 1"),
    "emission": Aov("RGB", "emitted radiance, linear Rec.709"),
    "occlusion": Aov("", "ambient visibility, 1 in the open"),
    "tangent": Aov("XYZ", "direction of the first texture coordinate"),
    "mip-level": Aov("", "level of the base colour texture that is sampled"),
    "fresnel": Aov("RGB", "reflectance at the angle that is seen, 0 to 1"),
    "uv": Aov("UV", "the first texture coordinates of the vertices"),
    "object-id": Aov(
        "",
        "1 + the node's number, counted on from model to model; 0 is nothing",
        dtype="uint32",
    ),
}


def parse_aovs(names: str | Iterable[str]) -> tuple[str, ...]:
    """The names of AOVs, from a list or a text with commas, each once.

    Raises OptionError for a name that is unknown.
    """
    if isinstance(names, str):
        names = [name.strip() for name in names.split(",")]
    wanted = tuple(dict.fromkeys(names))
    for name in wanted:
        if name not in AOVS:
            raise OptionError(
                f"AOV: {name!r} is unknown; choose from {', '.join(AOVS)}"
            )
    return wanted


def exr_layer(name: str) -> str:
    """The name of an AOV's layer as :func:`moka.core.exr.write_exr` has it.

    What is no AOV keeps its name.
    """
    aov = AOVS.get(name)
    return f"{name}.{aov.letters}" if aov and aov.letters else name
