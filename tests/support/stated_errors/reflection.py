"""Specular and diffuse terms, and the table of their albedo."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from moka.lighting.brdf_table import TABLE_SIZE, read_brdf_table
from tests.support.gpu import gpu
from tests.support.oracles import diffuse, specular, sun
from tests.support.oracles.directions import (
    Array,
    dot,
    half_vectors,
    hemisphere,
    random_directions,
    spherical,
)
from tests.support.stated_errors.grids import absolute, grid, relative, single

ROUGHNESSES = np.array([0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0])
COSINES = np.geomspace(1e-4, 1.0, 120)
COLOUR = np.array([0.1, 0.6, 1.0])
ANGLES = "angles_between(vec3(0.0, 0.0, 1.0), view, light)"


def pairs(count: int) -> tuple[Array, Array, Array]:
    """Views, lights and roughnesses as the shader gets them."""
    view, light = (
        single(random_directions(count, seed, 1e-3)) for seed in (1, 2)
    )
    generator = np.random.default_rng(3)
    return view, light, single(generator.uniform(0.05, 1.0, count))


def distribution_ggx() -> float:
    """Angles to four widths of the lobe and far beyond."""
    widths = np.concatenate((np.linspace(0.0, 4.0, 200), np.geomspace(4, 1e3)))
    alpha, widths = grid(np.append(0.002, ROUGHNESSES**2), widths)
    # Of the tangent, where the oracle's cosine would lose digits.
    squared = (alpha * widths) ** 2
    cosine = 1.0 / np.sqrt(1.0 + squared)
    value = gpu().evaluate(
        "distribution_ggx(c, s * s, alpha)",
        "brdf",
        c=cosine,
        s=cosine * alpha * widths,
        alpha=alpha,
    )
    expected = np.pi * cosine**4 * (alpha**2 + squared) ** 2
    return relative(value, alpha**2 / expected)


def visibility_smith() -> float:
    light, view, alpha = grid(COSINES, COSINES, ROUGHNESSES**2)
    value = gpu().evaluate(
        "visibility_smith_ggx_correlated(light, view, alpha)",
        "brdf",
        light=light,
        view=view,
        alpha=alpha,
    )
    return relative(value, specular.smith_correlated(light, view, alpha))


def visibility_schlick() -> float:
    light, view, k = grid(COSINES, COSINES, np.linspace(0.01, 0.5, 8))
    value = gpu().evaluate(
        "visibility_schlick_ggx(light, view, k)",
        "brdf",
        light=light,
        view=view,
        k=k,
    )
    return relative(value, specular.schlick_ggx(light, view, k))


def fresnel_schlick() -> float:
    cosine, f0 = grid(np.linspace(0.0, 1.0, 1000), [0.0, 0.04, 0.5, 1.0])
    value = gpu().evaluate("fresnel_schlick(c, f, 1.0)", "brdf", c=cosine, f=f0)
    return absolute(value, specular.schlick(cosine, f0))


def blinn_phong() -> float:
    """Relative to the peak: the lobe dies away exponentially."""
    alpha, scale = grid(ROUGHNESSES**2, np.linspace(0.0, 6.0, 400))
    theta = np.minimum(alpha * scale, 1.5)
    value = gpu().evaluate(
        "blinn_phong(s * s, alpha)", "brdf", s=np.sin(theta), alpha=alpha
    )
    expected = specular.blinn_phong(np.cos(theta), alpha)
    peak = specular.blinn_phong(np.ones_like(alpha), alpha)
    return float(np.max(np.abs(value - expected) / peak))


def specular_lobe() -> float:
    """From vectors, whose rounding counts in narrow lobes."""
    view, light, roughness = pairs(40000)
    value = gpu().evaluate(
        f"specular_lobe({ANGLES}, alpha_from_roughness(roughness), 0.0)",
        "brdf",
        view=view,
        light=light,
        roughness=roughness,
    )
    view, light = (
        x / np.linalg.norm(x, axis=-1, keepdims=True) for x in (view, light)
    )
    alpha = np.maximum(roughness**2, 0.002)
    return relative(
        value,
        specular.ggx(half_vectors(view, light)[:, 2], alpha)
        * specular.smith_correlated(light[:, 2], view[:, 2], alpha),
    )


def disc(incidence: float) -> float:
    """In parts of the peak, from a mirror's disc to where it is a point."""
    radius, worst = 0.00465, 0.0
    view = spherical(np.cos(incidence), 0.0)
    frame = np.stack((spherical(np.sin(incidence), np.pi), [0.0, 1.0, 0.0]))
    for alpha in (0.001, 0.002, 0.005, 0.01, 0.1, 1.0):
        reach = (radius + 2.0 * alpha) * np.array([0, 0.2, 0.5, 0.8, 1.5, 4])
        offset, turn = grid(np.tan(np.minimum(reach, 0.5)), [0.0, 0.8, 1.57])
        around = np.stack((np.cos(turn), np.sin(turn)), axis=-1) @ frame
        light = view * (-1, -1, 1) + offset[:, None] * -around
        light = single(light / np.linalg.norm(light, axis=-1, keepdims=True))
        light = light[light[:, 2] > 0.05]
        value = gpu().evaluate(
            f"distribution_ggx_of_disc({ANGLES}, dot(light - mirrored,"
            " light - mirrored), alpha, radius)",
            "sun_disc",
            {"MOKA_BRDF_GLTF": 1},
            view=np.tile(view, (len(light), 1)),
            mirrored=np.tile(view * (-1, -1, 1), (len(light), 1)),
            light=light,
            alpha=np.full(len(light), alpha),
            radius=np.full(len(light), radius),
        )
        expected = np.array(
            [sun.mean_distribution(view, x, alpha, radius) for x in light]
        )
        worst = max(worst, absolute(value, expected) / expected.max())
    return worst


def diffuse_brdf(name: str) -> float:
    view, light, roughness = pairs(40000)
    value = gpu().evaluate(
        f"diffuse_brdf({ANGLES}, colour, roughness)",
        ("brdf", "diffuse"),
        {f"MOKA_DIFFUSE_{name}": 1},
        view=view,
        light=light,
        roughness=roughness,
        colour=np.tile(COLOUR, (len(view), 1)),
    )
    return absolute(
        value, diffuse_oracle(name, view, light, roughness[:, None])
    )


def diffuse_albedo(name: str) -> float:
    """What is reflected of uniform light, against the lobe's integral."""
    directions, weights = hemisphere(64, 64)
    worst = 0.0
    for cosine in (0.02, 0.1, 0.3, 0.6, 1.0):
        for roughness in (0.0, 0.3, 0.7, 1.0):
            view = np.broadcast_to(spherical(cosine, 0.3), directions.shape)
            lobe = diffuse_oracle(name, view, directions, roughness)
            value = gpu().evaluate(
                "diffuse_albedo(cosine, colour, roughness)",
                ("brdf", "diffuse"),
                {f"MOKA_DIFFUSE_{name}": 1},
                cosine=cosine,
                roughness=roughness,
                colour=COLOUR[None, :],
            )
            worst = max(worst, absolute(value[0], weights @ lobe))
    return worst


def diffuse_oracle(
    name: str, view: Array, light: Array, roughness: ArrayLike
) -> Array:
    terms = (light[:, 2:], view[:, 2:], dot(view, light)[:, None])
    if name == "LAMBERT":
        return np.broadcast_to(diffuse.lambert(COLOUR), view.shape)
    if name == "OREN_NAYAR":
        return diffuse.oren_nayar(*terms, COLOUR, roughness)
    return diffuse.burley(*terms, COLOUR, roughness, name == "BURLEY")


def table(brdf: str) -> float:
    """Texels of the table, every other one."""
    value, n_dot_v, roughness = _table(brdf)
    visibility = (
        specular.smith_correlated
        if brdf == "gltf"
        else specular.schlick_ggx_environment
    )
    expected = specular.table_of_microfacets(n_dot_v, roughness, visibility)
    return absolute(value, expected)


def _table(brdf: str) -> tuple[Array, Array, Array]:
    """Entries (N, N, 2), and the n.v and roughness that they are of."""
    kept = np.append(np.arange(0, TABLE_SIZE, 2), TABLE_SIZE - 1)
    # A mirror and a grazing view are replaced by nearly ones.
    axis = np.maximum(np.linspace(0.0, 1.0, TABLE_SIZE)[kept], 1e-4)
    n_dot_v, roughness = np.meshgrid(axis, axis)
    return read_brdf_table(brdf)[np.ix_(kept, kept)], n_dot_v, roughness


def white_furnace() -> float:
    """True albedo of a white metal times the factor that makes it 1."""
    entries, n_dot_v, roughness = _table("gltf")
    scale = gpu().evaluate(
        "multiscatter_scale(vec3(1.0), entry).x",
        ("brdf", "multiscatter"),
        {"MOKA_MULTISCATTER": 1},
        entry=entries.reshape(-1, 2),
    )
    true = specular.table_of_microfacets(
        n_dot_v.ravel(), roughness.ravel(), specular.smith_correlated
    )
    return absolute(true.sum(axis=-1) * scale, np.ones(n_dot_v.size))


def mean_fresnel_power() -> float:
    """Over Lambertian light, against quadrature."""
    directions, weights = hemisphere(64, 128)
    cosine = np.linspace(0.0, 1.0, 101)
    expected = [
        weights
        @ (1.0 - np.sqrt(np.maximum(0.5 + 0.5 * directions @ view, 0.0))) ** 5
        / np.pi
        for view in spherical(cosine, 0.1)
    ]
    value = gpu().evaluate("mean_fresnel_power(c)", "multiscatter", c=cosine)
    return absolute(value, np.array(expected))


MEASURES: dict[str, Callable[[], float]] = {
    "distribution_ggx": distribution_ggx,
    "visibility_smith_ggx_correlated": visibility_smith,
    "visibility_schlick_ggx": visibility_schlick,
    "fresnel_schlick": fresnel_schlick,
    "blinn_phong": blinn_phong,
    "specular_lobe": specular_lobe,
    **{
        f"distribution_ggx_of_disc {degrees} degrees": (
            lambda degrees=degrees: disc(np.radians(degrees))
        )
        for degrees in (0, 30, 60)
    },
    **{
        f"{function.__name__} {name.lower()}": (
            lambda function=function, name=name: function(name)
        )
        for function in (diffuse_brdf, diffuse_albedo)
        for name in ("LAMBERT", "OREN_NAYAR", "BURLEY", "BURLEY_ORIGINAL")
    },
    "brdf_table.frag gltf": lambda: table("gltf"),
    "brdf_table.frag karis": lambda: table("karis"),
    "multiscatter_scale": white_furnace,
    "mean_fresnel_power": mean_fresnel_power,
}
