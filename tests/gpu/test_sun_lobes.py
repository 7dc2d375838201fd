"""Highlights of suns: GGX averaged over a disc, against the integral."""

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment, Sun
from moka.material.material import Material
from moka.model.geometry import sphere
from tests.support.gpu import gpu
from tests.support.oracles import reference
from tests.support.oracles import sun as oracle
from tests.support.oracles.directions import dot, spherical
from tests.support.patches import VIEW, draw_patches
from tests.support.pictures import draw_radiance, scene_of, square_camera
from tests.support.probe import LightingProbe

pytestmark = pytest.mark.gpu

RADIUS = 0.00465
COPPER = (0.95, 0.64, 0.54)
UP = np.array([0.0, 0.0, 1.0])


def around_the_mirror(
    view: np.ndarray, alpha: float, turns: int = 5
) -> np.ndarray:
    """Directions (N, 3) from the middle of the highlight outwards."""
    mirrored = view * (-1, -1, 1)
    along = np.cross([0.0, 1.0, 0.0], mirrored)
    across = np.cross(mirrored, along)
    reach = RADIUS + 2.0 * alpha
    offsets = reach * np.array([0.0, 0.2, 0.45, 0.8, 1.3, 2.5, 6.0])
    angles = np.linspace(0.0, np.pi, turns)
    found = [
        mirrored + np.tan(r) * (np.cos(a) * along + np.sin(a) * across)
        for r in offsets
        for a in angles
    ]
    towards = np.array(found)
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    return towards[towards[:, 2] > 0.05]


def distribution(
    view: np.ndarray, towards: np.ndarray, alpha: float
) -> np.ndarray:
    return gpu().evaluate(
        "distribution_ggx_of_disc(angles_between(vec3(0.0, 0.0, 1.0), v, l),"
        " dot(l - r, l - r), alpha, radius)",
        "sun_disc",
        {"MOKA_BRDF_GLTF": 1},
        v=np.tile(view, (len(towards), 1)),
        l=towards,
        r=np.tile(view * (-1, -1, 1), (len(towards), 1)),
        alpha=np.full(len(towards), alpha),
        radius=np.full(len(towards), RADIUS),
    )


@pytest.mark.parametrize(
    ("incidence", "tolerance"),
    # In parts of the peak. Away from the perpendicular the half vectors that
    # see the disc are an ellipse, and the lobe changes along it.
    [(0.0, 5e-4), (0.5, 0.012), (1.0, 0.085)],
)
@pytest.mark.parametrize("alpha", [0.001, 0.0023, 0.005, 0.01, 0.05, 0.4])
def test_the_mean_over_a_disc(
    incidence: float, tolerance: float, alpha: float
) -> None:
    view = spherical(np.cos(incidence), 0.0)
    l = around_the_mirror(view, alpha)  # noqa: E741
    exact = np.array(
        [oracle.mean_distribution(view, each, alpha, RADIUS) for each in l]
    )
    error = np.abs(distribution(view, l, alpha) - exact).max()
    assert error < tolerance * exact.max()


@pytest.mark.parametrize("incidence", [0.0, 0.6, 1.2, 1.5])
def test_a_mirror_shows_the_disc_itself(incidence: float) -> None:
    """The same radiance all over it, and nothing beside it."""
    view = spherical(np.cos(incidence), 0.0)
    l = around_the_mirror(view, 0.0, 9)  # noqa: E741
    offset = np.linalg.norm(l - view * (-1, -1, 1), axis=-1)
    inside = offset < RADIUS
    # D of 1 / 4 v.h of the disc's solid angle.
    h = l + view
    v_dot_h = dot(h / np.linalg.norm(h, axis=-1, keepdims=True), view[None])
    expected = inside * 4.0 * v_dot_h / (np.pi * RADIUS**2)
    value = distribution(view, l, 0.0)
    assert value == pytest.approx(expected, rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("alpha", [0.0005, 0.003, 0.02])
@pytest.mark.parametrize("incidence", [0.0, 0.9])
def test_no_light_is_made_or_lost(incidence: float, alpha: float) -> None:
    """The integral of D over half vectors is 1, whatever the disc."""
    view = spherical(np.cos(incidence), 0.0)
    reach = 40.0 * (alpha + RADIUS)
    radius = reach * ((np.arange(600) + 0.5) / 600) ** 2
    azimuth = (np.arange(96) + 0.5) / 96 * 2.0 * np.pi
    h = spherical(np.cos(radius)[:, None], azimuth[None, :]).reshape(-1, 3)
    l = 2.0 * (h @ view)[:, None] * h - view  # noqa: E741
    width = 2.0 * reach * np.sqrt(radius / reach) / 600
    weights = np.repeat(np.sin(radius) * width * 2.0 * np.pi / 96, 96)
    total = weights @ distribution(view, l, alpha)
    # What is farther than 40 widths away is missing.
    assert total == pytest.approx(1.0, abs=0.004)


def sun_at(towards: np.ndarray) -> Environment:
    """A sun in the dark."""
    x, y, z = towards.tolist()
    return Environment(
        np.zeros((1, 1, 3), np.float32), (Sun((x, y, z), (1, 1, 1), RADIUS),)
    )


@pytest.mark.parametrize("roughness", [0.0, 0.04, 0.07, 0.1, 0.2, 0.5])
def test_the_highlight_of_an_environments_own_sun(
    egl_device: GraphicsDevice, roughness: float
) -> None:
    """It is in no map, whose texels would be wider than the sun."""
    towards = np.array([0.48, 0.6, 0.64])
    probe = LightingProbe(egl_device, sun_at(towards))
    normals, views = [], []
    for incidence in (0.05, 0.6):
        side = np.cross(towards, [0.0, 1.0, 0.0])
        side /= np.linalg.norm(side)
        view = np.cos(2 * incidence) * towards + np.sin(2 * incidence) * side
        half = view + towards
        half /= np.linalg.norm(half)
        for tilt in (RADIUS + 2 * roughness**2) * np.linspace(-1, 1, 9):
            normal = half + tilt * np.cross(half, side)
            normals.append(normal / np.linalg.norm(normal))
            views.append(view)
    truth = np.array(
        [
            oracle.reflected(n, v, towards, RADIUS, roughness, COPPER)
            for n, v in zip(normals, views, strict=True)
        ]
    )
    shaded = probe.shade(normals, views, roughness, colour=COPPER)
    assert np.abs(shaded - truth).max() < 0.02 * truth.max()


@pytest.mark.parametrize("metalness", [1.0, 0.0])
def test_reference_lighting_samples_the_disc(
    egl_device: GraphicsDevice, metalness: float
) -> None:
    towards = np.array([0.0, 0.28, 0.96])
    half = towards + VIEW
    half /= np.linalg.norm(half)
    normals = np.array(
        [half + np.array([0.0, tilt, 0.0]) for tilt in (0.0, 3e-3, 0.02, 0.2)]
    )
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    roughnesses = (0.0, 0.08, 0.3, 1.0)
    drawn = draw_patches(
        egl_device,
        sun_at(towards),
        normals,
        [reference.Material(COPPER, metalness, r) for r in roughnesses],
        ibl="reference",
        reference_samples=256,
        multiscatter=False,
    ).mean(axis=2)
    f0 = np.array(COPPER) if metalness else np.full(3, 0.04)
    for row, roughness in zip(drawn, roughnesses, strict=True):
        for found, normal in zip(row, normals, strict=True):
            truth = oracle.reflected(
                normal, VIEW, towards, RADIUS, roughness, f0
            )
            if not metalness:
                passed = 1.0 - oracle.schlick(half @ VIEW, 0.04)
                truth += passed * (normal @ towards) * np.array(COPPER) / np.pi
            assert found == pytest.approx(truth, rel=0.01, abs=1e-6)


@pytest.mark.parametrize("size", [16, 48])
@pytest.mark.parametrize("roughness", [0.0, 0.1])
def test_a_glint_smaller_than_a_pixel_has_its_light(
    egl_device: GraphicsDevice, size: int, roughness: float
) -> None:
    """A mirror sphere scatters evenly: E a^2 / 4, wherever pixels lie.

    Without a disc that is wider by the pixel there was nothing in most
    pictures, and seven times as much in others.
    """
    found = []
    for x in (0.0, 0.15, 0.3, 0.45, 0.6):
        towards = np.array([x, 0.5, 0.8]) / np.linalg.norm([x, 0.5, 0.8])
        material = Material(roughness_factor=roughness)
        scene = scene_of(
            [(sphere(0.9, 96, 48), material, np.eye(4))],
            sun_at(towards),
            "transparent",
        )
        picture = draw_radiance(
            egl_device, scene, square_camera(), (size, size)
        )
        # Two metres wide and high.
        found.append(4.0 * picture[..., :3].mean())
    # Of a mirror one to four pixels have their centre in the disc.
    exact = 0.9**2 / 4.0
    assert np.mean(found) == pytest.approx(exact, rel=0.25)
    assert 0.4 * exact < min(found)
    assert max(found) < 2.1 * exact
