"""White furnaces: what comes back of uniform light, lobe and base together.

The environment's way (table and directional albedo) and the lights' way
(the BRDF, integrated over a dome of lights) have to agree.
"""

from functools import cache

import numpy as np
import pytest

from tests.support.gpu import gpu
from tests.support.oracles import specular as oracle
from tests.support.oracles.directions import (
    hemisphere,
    random_directions,
    spherical,
)

pytestmark = pytest.mark.gpu

SIZE = 64
AXIS = np.maximum(np.linspace(0.0, 1.0, SIZE), 1e-4)
BRDFS = ("GLTF", "KARIS", "BLINN_PHONG")
# Burley's original reflects too much by itself, see test_diffuse.
DIFFUSES = ("LAMBERT", "OREN_NAYAR", "BURLEY")
FILES = ("brdf", "diffuse", "multiscatter")
SPECULAR = (
    "specular_albedo(f0, vec3(1.0), entry) * multiscatter_scale(f0, entry)"
)
ANGLES = "angles_between(vec3(0.0, 0.0, 1.0), v, l)"


@cache
def table(brdf: str) -> np.ndarray:
    defines = {
        f"MOKA_BRDF_{brdf}": 1,
        "MOKA_SAMPLE_COUNT": 512,
        "MOKA_TABLE_SIZE": SIZE,
    }
    return gpu().draw("brdf_table.frag", (SIZE, SIZE), defines=defines)[..., :2]


def grid() -> tuple[np.ndarray, np.ndarray]:
    """n.v and roughness of the table's texels, as the shaders guard them."""
    n_dot_v, roughness = np.meshgrid(AXIS, AXIS)
    return n_dot_v.ravel(), roughness.ravel()


def metal(brdf: str, f0: float, *, compensated: bool) -> np.ndarray:
    defines = {f"MOKA_BRDF_{brdf}": 1}
    if compensated:
        defines["MOKA_MULTISCATTER"] = 1
    entries = table(brdf).reshape(-1, 2)
    return gpu().evaluate(
        SPECULAR,
        FILES,
        defines,
        entry=entries,
        f0=np.full((len(entries), 3), f0),
    )


@pytest.mark.parametrize("brdf", ["GLTF", "KARIS"])
def test_a_white_metal_returns_everything_with_compensation(brdf):
    assert np.abs(metal(brdf, 1.0, compensated=True) - 1.0).max() < 1e-5


@pytest.mark.parametrize("brdf", BRDFS)
@pytest.mark.parametrize("f0", [0.04, 0.5, 1.0])
def test_a_metal_never_returns_more_than_it_gets(brdf, f0):
    without = metal(brdf, f0, compensated=False)
    compensated = metal(brdf, f0, compensated=True)
    assert without.max() <= 1.0 + 1e-6
    assert compensated.max() <= 1.0 + 1e-5
    assert (compensated >= without - 1e-6).all()


def test_what_lights_return_of_a_white_metal_is_everything_too():
    """The lobe's true albedo times the factor from the GPU's table."""
    n_dot_v, roughness = grid()
    true = oracle.table_of_microfacets(
        n_dot_v, roughness, oracle.smith_correlated, 24
    ).sum(axis=-1)
    scale = gpu().evaluate(
        "multiscatter_scale(vec3(1.0), entry).x",
        FILES,
        {"MOKA_MULTISCATTER": 1},
        entry=table("GLTF").reshape(-1, 2),
    )
    assert np.abs(true * scale - 1.0).max() < 0.01


@pytest.mark.parametrize("brdf", BRDFS)
@pytest.mark.parametrize("diffuse", DIFFUSES)
@pytest.mark.parametrize("f0", [0.0, 0.04, 0.16])
def test_a_white_dielectric_returns_what_it_gets(brdf, diffuse, f0):
    n_dot_v, roughness = grid()
    returned = gpu().evaluate(
        f"{SPECULAR} + diffuse_share({SPECULAR})"
        " * diffuse_albedo(n_dot_v, vec3(1.0), roughness)",
        FILES,
        {
            f"MOKA_BRDF_{brdf}": 1,
            f"MOKA_DIFFUSE_{diffuse}": 1,
            "MOKA_MULTISCATTER": 1,
        },
        entry=table(brdf).reshape(-1, 2),
        f0=np.full((SIZE * SIZE, 3), f0),
        n_dot_v=n_dot_v,
        roughness=roughness,
    )
    if diffuse == "BURLEY":
        # The published renormalisation is approximate, see test_diffuse.
        assert returned.max() <= 1.031
    else:
        assert np.abs(returned - 1.0).max() <= 1e-5


@pytest.mark.parametrize("diffuse", DIFFUSES)
def test_a_dome_of_lights_is_a_furnace(diffuse):
    """Environment and lights agree on the whole material."""
    l, weights = hemisphere(96, 96)  # noqa: E741
    defines = {f"MOKA_DIFFUSE_{diffuse}": 1, "MOKA_MULTISCATTER": 1}
    for row, column in ((30, 5), (30, 40), (50, 20), (63, 63), (63, 2)):
        cosine, r = AXIS[column], AXIS[row]
        same = {
            "entry": np.tile(table("GLTF")[row, column], (len(l), 1)),
            "f0": np.full((len(l), 3), 0.04),
            "colour": np.tile([1.0, 0.7, 0.2], (len(l), 1)),
            "roughness": np.full(len(l), r),
            "n_dot_v": np.full(len(l), cosine),
            "v": np.tile(spherical(cosine, 1.0), (len(l), 1)),
            "l": l,
        }
        lit = gpu().evaluate(
            f"specular_brdf({ANGLES}, roughness, f0, vec3(1.0))"
            f" * multiscatter_scale(f0, entry) + diffuse_share({SPECULAR})"
            f" * diffuse_brdf({ANGLES}, colour, roughness)",
            FILES,
            defines,
            **same,
        )
        furnace = gpu().evaluate(
            f"{SPECULAR} + diffuse_share({SPECULAR})"
            " * diffuse_albedo(n_dot_v, colour, roughness)",
            FILES,
            defines,
            **{name: value[:1] for name, value in same.items()},
        )
        assert np.abs(weights @ lit - furnace[0]).max() < 5e-3


def test_without_compensation_a_dome_and_an_environment_agree_too():
    """Appendix B's 1 - F(v.h) for each light, its mean for all of them."""
    l, weights = hemisphere(96, 96)  # noqa: E741
    for cosine in (0.02, 0.2, 0.5, 0.8, 1.0):
        lit = gpu().evaluate(
            f"(1.0 - fresnel_schlick(({ANGLES}).v_dot_h, 0.04, 1.0)) / PI",
            FILES,
            v=np.tile(spherical(cosine, 1.0), (len(l), 1)),
            l=l,
        )
        furnace = gpu().evaluate(
            "diffuse_share(mix(vec3(0.04), vec3(1.0), mean_fresnel_power(c)))",
            FILES,
            c=np.array([cosine]),
        )
        assert weights @ lit == pytest.approx(furnace[0], abs=1e-4)


@pytest.mark.parametrize("brdf", BRDFS)
@pytest.mark.parametrize("diffuse", [*DIFFUSES, "BURLEY_ORIGINAL"])
def test_reciprocity_of_every_combination(brdf, diffuse):
    """The lobe and the base; how they share light depends on the view."""
    v = random_directions(4000, 1, 1e-3)
    l = random_directions(4000, 2, 1e-3)  # noqa: E741
    roughness = np.random.default_rng(3).uniform(0.05, 1.0, 4000)
    expression = (
        f"specular_brdf({ANGLES}, roughness, vec3(0.04), vec3(1.0))"
        f" + diffuse_brdf({ANGLES}, vec3(0.2, 0.5, 0.9), roughness)"
    )
    defines = {f"MOKA_BRDF_{brdf}": 1, f"MOKA_DIFFUSE_{diffuse}": 1}
    forth, back = (
        gpu().evaluate(
            expression, FILES, defines, v=a, l=b, roughness=roughness
        )
        for a, b in ((v, l), (l, v))
    )
    assert np.max(np.abs(forth - back) / np.maximum(forth, 1e-6)) < 5e-6
