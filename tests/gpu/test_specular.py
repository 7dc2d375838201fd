"""Specular terms in GLSL against float64, and their behaviour at limits."""

import numpy as np
import pytest

from moka.core.fresnel import fresnel_conductor, fresnel_dielectric
from tests.support.gpu import gpu
from tests.support.oracles import specular as oracle
from tests.support.oracles.directions import (
    half_vectors,
    random_directions,
    spherical,
)

pytestmark = pytest.mark.gpu

N = np.array([[0.0, 0.0, 1.0]])
GLTF = {"MOKA_BRDF_GLTF": 1}
KARIS = {"MOKA_BRDF_KARIS": 1}
BLINN_PHONG = {"MOKA_BRDF_BLINN_PHONG": 1}
LOBE = (
    "specular_lobe(angles_between(vec3(0.0, 0.0, 1.0), v, l), "
    "alpha_from_roughness(roughness), schlick_k_direct(roughness))"
)
BRDF = (
    "specular_brdf(angles_between(vec3(0.0, 0.0, 1.0), v, l), roughness, "
    "vec3(0.04, 0.5, 1.0), vec3(1.0)) * max(l.z, 0.0)"
)


def pairs(count: int = 20000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Views, lights, both at least 0.6 degrees above the horizon, and
    roughnesses; half of the lights are near the mirrored view."""
    v = random_directions(count, 1, 0.01)
    l = random_directions(count, 2, 0.01)  # noqa: E741
    generator = np.random.default_rng(3)
    roughness = generator.uniform(0.05, 1.0, count)
    mirrored = v * [-1.0, -1.0, 1.0]
    jitter = generator.normal(0.0, 1.0, (count, 3)) * roughness[:, None] ** 2
    near = mirrored + jitter
    near /= np.linalg.norm(near, axis=-1, keepdims=True)
    l = np.where((near[:, 2:] > 0.01) & (roughness[:, None] < 0.5), near, l)  # noqa: E741
    as_float32 = [x.astype(np.float32).astype(float) for x in (v, l, roughness)]
    return as_float32[0], as_float32[1], as_float32[2]


def unit(x: np.ndarray) -> np.ndarray:
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def relative_error(value: np.ndarray, expected: np.ndarray) -> float:
    return float(np.max(np.abs(value - expected) / np.abs(expected)))


@pytest.mark.parametrize("alpha", [0.002, 0.01, 0.1, 0.5, 1.0])
def test_ggx_near_its_peak_and_far(alpha):
    theta = np.concatenate(
        (alpha * np.linspace(0.0, 4.0, 400), np.linspace(0.0, 1.5, 400))
    )
    theta = theta[theta < 1.55]
    value = gpu().evaluate(
        "distribution_ggx(c, s * s, alpha)",
        "brdf",
        c=np.cos(theta),
        s=np.sin(theta),
        alpha=np.full_like(theta, alpha),
    )
    assert relative_error(value, oracle.ggx(np.cos(theta), alpha)) < 2e-6


def test_the_angle_of_a_half_vector_keeps_its_precision_at_the_peak():
    """|n x h|^2 from vectors; 1 - (n.h)^2 would be noise below 1e-7."""
    angle = np.geomspace(1e-4, 0.5, 200)
    v = spherical(np.full(200, 0.8), np.zeros(200))
    polar = np.arccos(0.8) + 2.0 * angle
    l = spherical(np.cos(polar), np.full(200, np.pi))  # noqa: E741
    value = gpu().evaluate(
        "angles_between(vec3(0.0, 0.0, 1.0), v, l).n_cross_h_squared",
        "angles",
        v=v,
        l=l,
    )
    error = np.abs(np.sqrt(value) - np.sin(angle))
    assert error.max() < 2e-7


@pytest.mark.parametrize("alpha", [0.002, 0.05, 0.3, 1.0])
def test_correlated_smith(alpha):
    l, v = (x.ravel() for x in np.meshgrid(*2 * [np.geomspace(1e-4, 1, 90)]))  # noqa: E741
    value = gpu().evaluate(
        "visibility_smith_ggx_correlated(l, v, alpha)",
        "brdf",
        l=l,
        v=v,
        alpha=np.full_like(l, alpha),
    )
    expected = oracle.smith_correlated(l, v, np.array(alpha))
    assert relative_error(value, expected) < 1e-6


def test_correlated_smith_is_never_darker_than_separable():
    l, v = np.meshgrid(*2 * [np.linspace(0.01, 1, 60)])  # noqa: E741
    for alpha in np.array([0.1, 0.5, 1.0]):
        correlated = oracle.smith_correlated(l, v, alpha)
        assert (correlated >= oracle.smith_separable(l, v, alpha)).all()


@pytest.mark.parametrize("which", ["direct", "environment"])
def test_schlick_ggx(which):
    l, v = (x.ravel() for x in np.meshgrid(*2 * [np.geomspace(1e-3, 1, 60)]))  # noqa: E741
    for roughness in (0.1, 0.5, 1.0):
        k = {
            "direct": (roughness + 1.0) ** 2 / 8.0,
            "environment": roughness**2 / 2.0,
        }[which]
        value = gpu().evaluate(
            f"visibility_schlick_ggx(l, v, schlick_k_{which}(r))",
            "brdf",
            l=l,
            v=v,
            r=np.full_like(l, roughness),
        )
        assert relative_error(value, oracle.schlick_ggx(l, v, k)) < 1e-6


def test_schlick_fresnel_scalar_and_colour():
    cosine = np.linspace(0.0, 1.0, 500)
    scalar = gpu().evaluate("fresnel_schlick(c, 0.04, 0.9)", "brdf", c=cosine)
    expected = oracle.schlick(cosine, 0.04, 0.9)
    assert np.abs(scalar - expected).max() < 2e-7
    f0 = np.array([0.04, 0.6, 1.0])
    colour = gpu().evaluate(
        "fresnel_schlick(c, f0, vec3(1.0))",
        "brdf",
        c=cosine,
        f0=np.tile(f0, (500, 1)),
    )
    expected = oracle.schlick(cosine[:, None], f0)
    assert np.abs(colour - expected).max() < 2e-7


def test_schlick_is_close_to_fresnel():
    """What the approximation costs, for glass and for two metals."""
    cosine = np.linspace(0.0, 1.0, 500)
    exact = {
        0.036: fresnel_dielectric(cosine, 1.5),
        0.017: fresnel_conductor(cosine, 0.143, 3.983),  # gold, red
        0.118: fresnel_conductor(cosine, 1.37, 7.62),  # aluminium
    }
    assert exact[0.036][-1] == pytest.approx(0.04)
    for error, reflectance in exact.items():
        approximation = oracle.schlick(cosine, reflectance[-1])
        assert np.abs(approximation - reflectance).max() < error


def test_grazing_reflectance_of_a_rough_surface():
    value = gpu().evaluate(
        "f90_of_rough_surface(vec3(0.04, 0.5, 0.9), r)",
        "brdf",
        r=np.array([0.0, 0.3, 1.0]),
    )
    expected = [[1, 1, 1], [0.7, 0.7, 0.9], [0.04, 0.5, 0.9]]
    assert np.abs(value - expected).max() < 1e-6


@pytest.mark.parametrize("defines", [GLTF, KARIS, BLINN_PHONG])
def test_the_whole_lobe(defines):
    v, l, roughness = pairs()  # noqa: E741
    value = gpu().evaluate(LOBE, "brdf", defines, v=v, l=l, roughness=roughness)
    v, l = unit(v), unit(l)  # noqa: E741
    alpha = np.maximum(roughness**2, 0.002)
    n_dot_h = half_vectors(v, l)[:, 2]
    if defines is GLTF:
        visibility = oracle.smith_correlated(l[:, 2], v[:, 2], alpha)
        expected = oracle.ggx(n_dot_h, alpha) * visibility
    elif defines is KARIS:
        k = (roughness + 1.0) ** 2 / 8.0
        visibility = oracle.schlick_ggx(l[:, 2], v[:, 2], k)
        expected = oracle.ggx(n_dot_h, alpha) * visibility
    else:
        expected = oracle.blinn_phong(n_dot_h, alpha)
    # Inputs are float32: they place h within 1e-7, of a lobe as narrow as
    # 0.0025; against its peak where Blinn-Phong dies away exponentially.
    peak = expected.max() if defines is BLINN_PHONG else np.abs(expected)
    assert np.max(np.abs(value - expected) / peak) < 5e-4


@pytest.mark.parametrize("defines", [GLTF, KARIS, BLINN_PHONG])
def test_reciprocity(defines):
    v, l, roughness = pairs()  # noqa: E741
    forth = gpu().evaluate(LOBE, "brdf", defines, v=v, l=l, roughness=roughness)
    back = gpu().evaluate(LOBE, "brdf", defines, v=l, l=v, roughness=roughness)
    # The sum v + l commutes; only the order of additions in V can differ.
    assert np.max(np.abs(forth - back) / forth.clip(1e-30)) < 1e-6


@pytest.mark.parametrize("defines", [GLTF, KARIS, BLINN_PHONG])
@pytest.mark.parametrize("roughness", [0.0, 1e-3, 0.045, 0.3, 1.0])
@pytest.mark.parametrize("dtype", [np.float32, np.float16])
def test_no_direction_gives_anything_but_finite_light(
    defines, roughness, dtype
):
    """Around the horizon and below it, at the peak, and face to face."""
    cosine = [-1, -0.5, -1e-3, -1e-7, 0, 1e-30, 1e-7, 1e-4, 0.1, 0.7, 1]
    azimuth = [0.0, 0.5 * np.pi, np.pi, 3.0]
    directions = spherical(*(x.ravel() for x in np.meshgrid(cosine, azimuth)))
    v = np.repeat(directions, len(directions), axis=0)
    l = np.tile(directions, (len(directions), 1))  # noqa: E741
    value = gpu().evaluate(
        f"min({BRDF}, HALF_MAXIMUM)" if dtype is np.float16 else BRDF,
        "brdf",
        defines,
        v=v,
        l=l,
        roughness=np.full(len(v), roughness),
    )
    stored = value.astype(dtype)
    assert np.isfinite(stored).all()
    assert (stored >= 0.0).all()
    assert not stored[l[:, 2] <= 0.0].any()


def test_a_smooth_lobe_keeps_the_energy_of_a_mirror():
    """The least alpha bounds the peak, and the albedo stays that of F."""
    table = oracle.table_of_microfacets(
        np.array([0.2, 0.6, 1.0]), np.sqrt(0.002), oracle.smith_correlated
    )
    assert np.abs(table.sum(axis=-1) - 1.0).max() < 1e-3


def test_the_blinn_phong_highlight_shrinks_with_smoothness():
    roughness = np.array([0.1, 0.3, 0.6, 1.0])
    up = np.tile(N, (4, 1))
    peak = gpu().evaluate(
        LOBE, "brdf", BLINN_PHONG, v=up, l=up, roughness=roughness
    )
    assert (np.diff(peak) < 0.0).all()
    assert peak[3] == pytest.approx(1.0 / np.pi, rel=1e-6)
