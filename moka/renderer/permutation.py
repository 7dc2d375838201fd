"""Which program draws a material under the lighting of a frame."""

from msgspec import Struct

from moka.commands.descriptors import ProgramDescriptor
from moka.graphics.shader_source import load_shader
from moka.graphics.uniform_block import (
    Parameter,
    ParameterType,
    UniformLayout,
)
from moka.material.description import (
    Feature,
    MaterialDescription,
    defines_of,
)
from moka.material.parameters import RowPart, material_layout
from moka.renderer.frame_block import FRAME

__all__ = [
    "LightingDescription",
    "Permutation",
    "lights_layout",
    "materials_layout",
    "row_parts",
    "visibility_program",
]

# A uniform block of 16 KiB is what every driver has.
_BLOCK_BYTES = 16384


def lights_layout(capacity: int) -> UniformLayout:
    """The block ``Lights``: rows of :data:`moka.scene.lights.LIGHT`."""
    return UniformLayout(
        "Lights",
        (
            Parameter("position", ParameterType.VEC3),
            Parameter("positional", ParameterType.FLOAT),
            Parameter("direction", ParameterType.VEC3),
            Parameter("inverse_range", ParameterType.FLOAT),
            Parameter("intensity", ParameterType.VEC3),
            Parameter("angle_scale", ParameterType.FLOAT),
            Parameter("angle_offset", ParameterType.FLOAT),
            Parameter("angular_radius", ParameterType.FLOAT),
            Parameter("in_map", ParameterType.FLOAT),
        ),
        capacity,
    )


def materials_layout(parts: RowPart) -> UniformLayout:
    """A page of the material table: as many rows as a block can hold."""
    row = material_layout(1, parts)
    return material_layout(_BLOCK_BYTES // row.size, parts)


def row_parts(material: MaterialDescription) -> RowPart:
    """What rows of such materials hold beyond what all do."""
    parts = RowPart(0)
    if any(use.has_transform for use in material.textures):
        parts |= RowPart.TRANSFORMS
    if Feature.SPECULAR in material.features:
        parts |= RowPart.SPECULAR
    return parts


class LightingDescription(Struct, frozen=True):
    """What lights a frame, as far as it changes the shader's text.

    With ``harmonics`` irradiance comes from nine coefficients, not a cube.
    ``light_capacity`` is 0 without punctual lights, else the power of two
    that holds them; ``positional`` tells whether some are anywhere but in
    infinity, ``turned`` whether the environment has a rotation. ``ibl`` is
    how the environment lights, ``part`` which of the light is drawn:
    ``all``, ``diffuse``, ``specular``, or ``irradiance``, that of surfaces
    which are white and reflect nothing else. What the target wants stands here
    too: ``float_target``, ``logarithmic_depth``, and the groups of
    ``values`` that are drawn in the place of radiance, which
    :mod:`moka.renderer.surface_values` names; ``visibility`` is how many
    samples of a pixel a visibility buffer has, 0 where surfaces are shaded as
    they are drawn.
    """

    environment: bool
    light_capacity: int
    brdf: str
    diffuse: str
    multiscatter: bool
    float_target: bool
    harmonics: bool = False
    ibl: str = "split-sum"
    logarithmic_depth: bool = False
    positional: bool = True
    turned: bool = True
    part: str = "all"
    values: tuple[str, ...] = ()
    visibility: int = 0

    def defines(self, features: Feature) -> dict[str, int]:
        """The defines for a material with ``features``."""
        defines: dict[str, int] = {}
        if self.float_target:
            defines["MOKA_FLOAT_TARGET"] = 1
        if self.logarithmic_depth:
            defines["MOKA_LOGARITHMIC_DEPTH"] = 1
        if self.values:
            # Each group of values has a target of its own.
            return defines | {
                "MOKA_OBJECT": 1,
                **{
                    f"MOKA_VALUES_{_macro(group)}": target
                    for target, group in enumerate(self.values)
                },
            }
        if Feature.UNLIT in features:
            return defines
        defines[f"MOKA_BRDF_{_macro(self.brdf)}"] = 1
        defines[f"MOKA_DIFFUSE_{_macro(self.diffuse)}"] = 1
        if self.environment:
            defines["MOKA_ENVIRONMENT"] = 1
            if self.turned:
                defines["MOKA_TURNED_ENVIRONMENT"] = 1
            if self.ibl != "split-sum":
                defines[f"MOKA_IBL_{_macro(self.ibl)}"] = 1
            if Feature.DIFFUSE in features or self.part == "irradiance":
                defines["MOKA_IRRADIANCE"] = 1
                if self.harmonics:
                    defines["MOKA_IRRADIANCE_SH"] = 1
        if self.light_capacity:
            defines["MOKA_PUNCTUAL_LIGHTS"] = self.light_capacity
            if self.positional:
                defines["MOKA_POSITIONAL_LIGHTS"] = 1
        if self.part != "all":
            defines[f"MOKA_PART_{_macro(self.part)}"] = 1
        if self.multiscatter:
            defines["MOKA_MULTISCATTER"] = 1
        if self.needs_table:
            defines["MOKA_BRDF_TABLE"] = 1
        return defines

    @property
    def needs_table(self) -> bool:
        """Whether lit materials read the table of directional albedo."""
        approximates = self.environment and self.ibl != "reference"
        lit = self.environment or bool(self.light_capacity)
        return approximates or (lit and self.multiscatter)


class Permutation(Struct, frozen=True):
    """Key of the table of loaded surface programs."""

    material: MaterialDescription
    lighting: LightingDescription

    @property
    def row_parts(self) -> RowPart:
        """What its material rows hold beyond what all do."""
        return row_parts(self.material)

    def program(self) -> ProgramDescriptor:
        """The sources that compile it."""
        features = self.material.features
        defines: dict[str, str | int] = {
            **defines_of(self.material),
            **self.lighting.defines(features),
        }
        vertex_name, kind = "surface.vert", "surface"
        vertex_blocks = blocks = FRAME.glsl
        if self.lighting.visibility:
            from moka.renderer.visible_geometry import visible_defines

            vertex_name, kind = "visible_surface.vert", "visible_surface"
            defines["MOKA_VISIBILITY"] = self.lighting.visibility
            defines |= visible_defines(self.material.attributes)
            vertex_blocks += FRAME.flat_outputs
            blocks = FRAME.flat_inputs
        elif self.lighting.values:
            kind = "surface_values"
        blocks += materials_layout(self.row_parts).glsl
        if "MOKA_PUNCTUAL_LIGHTS" in defines:
            blocks += lights_layout(self.lighting.light_capacity).glsl
        names = " ".join(name.removeprefix("MOKA_") for name in defines)
        return ProgramDescriptor(
            load_shader(vertex_name, defines, injected=vertex_blocks),
            load_shader(f"{kind}.frag", defines, injected=blocks),
            f"{kind} ({names})",
        )


def visibility_program() -> ProgramDescriptor:
    """The sources that note which triangle is seen, of any material."""
    return ProgramDescriptor(
        load_shader("visibility.vert", injected=FRAME.glsl),
        load_shader("visibility.frag"),
        "visibility",
    )


def _macro(option: str) -> str:
    return option.upper().replace("-", "_")
