"""All cases of features, by the subject of their section on the page."""

from tests.conformance.animations import ANIMATIONS
from tests.conformance.case import Case
from tests.conformance.characters import CHARACTERS
from tests.conformance.compressed import COMPRESSED
from tests.conformance.dielectrics import DIELECTRICS
from tests.conformance.geometry import GEOMETRY
from tests.conformance.lights import LIGHTS
from tests.conformance.materials import MATERIALS
from tests.conformance.scenes import SCENES
from tests.conformance.texture_use import TEXTURE_USE
from tests.conformance.textures import TEXTURES

__all__ = ["FEATURES"]

FEATURES: dict[str, list[Case]] = {
    "Geometry and nodes": GEOMETRY,
    "Materials": [*MATERIALS, *DIELECTRICS],
    "Textures": [*TEXTURES, *TEXTURE_USE],
    "Lamps and cameras": LIGHTS,
    "Animations": ANIMATIONS,
    "Skins and morph targets": CHARACTERS,
    "Instances, scenes, variants, levels": SCENES,
    "Compressed data": COMPRESSED,
}
