"""Every full-screen pass and every include compiles as GLSL 330 core."""

from itertools import product

import pytest

from moka.core.resources import shader_folder
from moka.graphics.shader_source import load_shader, preprocess_shader
from tests.support.gpu import gpu

pytestmark = pytest.mark.gpu

BRDFS = ("MOKA_BRDF_GLTF", "MOKA_BRDF_KARIS", "MOKA_BRDF_BLINN_PHONG")
DIFFUSES = (
    "MOKA_DIFFUSE_LAMBERT",
    "MOKA_DIFFUSE_OREN_NAYAR",
    "MOKA_DIFFUSE_BURLEY",
    "MOKA_DIFFUSE_BURLEY_ORIGINAL",
)
TONE_MAPS = (
    "MOKA_TONE_MAP_NEUTRAL",
    "MOKA_TONE_MAP_ACES",
    "MOKA_TONE_MAP_AGX",
    "MOKA_TONE_MAP_REINHARD",
    "MOKA_TONE_MAP_EXPONENTIAL",
    "MOKA_TONE_MAP_NONE",
)
SIZES = ("MOKA_SIZE", "MOKA_SUBDIVISIONS")
PASSES = [
    *(
        ("equirectangular_to_cube.frag", (*SIZES, *face))
        for face in ((), ("MOKA_FACE",))
    ),
    ("downsample_cube.frag", ()),
    ("accumulate.frag", ()),
    ("accumulate_batch.frag", ()),
    ("resolve_samples.frag", ()),
    ("tile_error.frag", ()),
    ("prefilter_specular.frag", ("MOKA_SAMPLE_COUNT",)),
    ("prefilter_irradiance.frag", ("MOKA_SAMPLE_COUNT",)),
    *(
        ("brdf_table.frag", ("MOKA_SAMPLE_COUNT", "MOKA_TABLE_SIZE", brdf))
        for brdf in BRDFS
    ),
]
SCREEN_PASSES = [
    ("background.frag", {"MOKA_SKY": 1}),
    ("background.frag", {"MOKA_SKY": 1, "MOKA_SUN_DISCS": 64}),
    *(
        ("tone_map.frag", {"MOKA_DISPLAY": 1, tone_map: 1, **gamma, **colour})
        for tone_map in TONE_MAPS
        for gamma in ({}, {"MOKA_ENCODE_GAMMA": 1})
        for colour in ({}, {"MOKA_BACKGROUND_COLOUR": 1})
    ),
    *(
        (shader, {**display, **scene})
        for shader, display in (
            ("resolve.frag", {}),
            ("tone_map.frag", {"MOKA_DISPLAY": 1}),
        )
        for scene in (
            {"MOKA_SAMPLES": 4},
            {"MOKA_SKY": 1},
            {"MOKA_SKY": 1, "MOKA_BLURRED_SKY": 1, "MOKA_SUN_DISCS": 1},
            # As many as vertices hand on, and one more.
            {"MOKA_SKY": 1, "MOKA_SAMPLES": 4, "MOKA_SUN_DISCS": 4},
            {"MOKA_SKY": 1, "MOKA_SAMPLES": 4, "MOKA_SUN_DISCS": 5},
        )
    ),
]
# Files that need the defines and the injected text of a material; they are
# compiled with it.
PARTS_OF_SURFACE = {
    "frame.glsl",
    "instance.glsl",
    "lighting.glsl",
    "material.glsl",
    "morph.glsl",
    "shading_normal.glsl",
    "skin.glsl",
    "surface_radiance.glsl",
    "visible_triangle.glsl",
}
# For vertex shaders, which are compiled above.
OF_VERTICES = {"fullscreen.glsl"}
INCLUDES = sorted(
    {path.name for path in (shader_folder() / "include").glob("*.glsl")}
    - PARTS_OF_SURFACE
    - OF_VERTICES
)


@pytest.mark.parametrize(("name", "defines"), PASSES)
def test_a_pass_compiles_in_all_its_permutations(name, defines):
    fragment = load_shader(name, dict.fromkeys(defines, 4))
    gpu().compile(load_shader("fullscreen.vert"), fragment)


@pytest.mark.parametrize(("name", "defines"), SCREEN_PASSES)
def test_a_screen_pass_compiles_in_its_permutations(name, defines):
    fragment = load_shader(name, defines)
    gpu().compile(load_shader("screen.vert", defines), fragment)


@pytest.mark.parametrize("name", INCLUDES)
def test_an_include_compiles_by_itself_and_has_no_main(name):
    text = preprocess_shader(f'#include "include/{name}"\nvoid main() {{}}')
    gpu().compile(load_shader("fullscreen.vert"), text)


@pytest.mark.parametrize(("brdf", "diffuse"), [*product(BRDFS, DIFFUSES)])
def test_reflection_compiles_in_all_its_permutations(brdf, diffuse):
    text = preprocess_shader(
        '#include "include/brdf.glsl"\n#include "include/diffuse.glsl"\n'
        '#include "include/multiscatter.glsl"\nvoid main() {}',
        {brdf: 1, diffuse: 1, "MOKA_MULTISCATTER": 1},
    )
    gpu().compile(load_shader("fullscreen.vert"), text)
