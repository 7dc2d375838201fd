"""Where directions are in maps, and the passes from map to cube to light."""

import numpy as np
import pytest

from moka.core.solid_angle import cube_texel_solid_angles
from moka.lighting.samples import ggx_prefilter_samples, pack
from tests.support.cube_passes import (
    convolve,
    draw_cube,
    prefilter,
    resample,
    smooth,
    texel_directions,
)
from tests.support.gpu import gpu
from tests.support.oracles import environment as oracle
from tests.support.oracles.directions import random_directions

pytestmark = pytest.mark.gpu

AXES = np.array(
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    dtype=float,
)


def test_the_six_axes_in_an_equirectangular_map():
    """The image's centre is +X, its top +Y, three quarters along is +Z."""
    uv = gpu().evaluate(
        "equirectangular_from_direction(d)", "environment", d=AXES
    )
    assert uv[0] == pytest.approx([0.5, 0.5], abs=1e-6)
    assert uv[1][0] % 1.0 == pytest.approx(0.0, abs=1e-6)
    assert uv[1][1] == pytest.approx(0.5)
    assert uv[2][1] == pytest.approx(0.0, abs=1e-6)
    assert uv[3][1] == pytest.approx(1.0, abs=1e-6)
    assert uv[4] == pytest.approx([0.75, 0.5], abs=1e-6)
    assert uv[5] == pytest.approx([0.25, 0.5], abs=1e-6)
    assert np.isfinite(uv).all()


def test_equirectangular_coordinates_are_precise_at_the_poles():
    size = np.geomspace(1e-6, 1.0, 100)
    d = np.stack((size, np.ones(100), 0.5 * size), axis=-1)
    v = gpu().evaluate(
        "equirectangular_from_direction(d).y", "environment", d=d
    )
    expected = np.arctan2(np.hypot(size, 0.5 * size), 1.0) / np.pi
    # Mesa's acos alone is wrong by 1.6e-4 radians.
    assert np.abs(v - expected).max() < 6e-7


@pytest.mark.parametrize("length", [1e-9, 1e9])
def test_equirectangular_coordinates_of_any_length(length):
    d = np.concatenate((AXES, random_directions(500, 1, -1.0)))
    d = d.astype(np.float32)
    unit, scaled = (
        gpu().evaluate("equirectangular_from_direction(d)", "environment", d=x)
        for x in (d, d * np.float32(length))
    )
    assert np.abs(unit - scaled).max() < 4e-7


def test_equirectangular_coordinates_there_and_back():
    d = random_directions(5000, 1, -1.0)
    uv = gpu().evaluate("equirectangular_from_direction(d)", "environment", d=d)
    expected_u = 0.5 + np.arctan2(d[:, 2], d[:, 0]) / (2.0 * np.pi)
    # The map repeats, so whole turns don't matter.
    turns = uv[:, 0] - expected_u
    assert np.abs(turns - np.rint(turns)).max() < 4e-7
    assert np.abs(uv[:, 1] - np.arccos(d[:, 1]) / np.pi).max() < 6e-7
    back = gpu().evaluate(
        "direction_from_equirectangular(uv)", "environment", uv=uv
    )
    assert np.abs(back - d).max() < 1e-5


def test_directions_of_cube_faces():
    directions = texel_directions(16)
    places = (np.arange(16) + 0.5) / 16
    v, u = np.meshgrid(places, places, indexing="ij")
    for face in range(6):
        value = gpu().evaluate(
            f"direction_from_cube_face({face}, uv)",
            "environment",
            uv=np.stack((u.ravel(), v.ravel()), axis=-1),
        )
        assert np.abs(value).max() == 1.0
        unit = value / np.linalg.norm(value, axis=-1, keepdims=True)
        assert np.abs(unit - directions[face].reshape(-1, 3)).max() < 1e-6


def test_solid_angles_of_cube_texels():
    size = 64
    exact = cube_texel_solid_angles(size)
    assert 6.0 * exact.sum() == pytest.approx(4.0 * np.pi)
    centre = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y = (a.ravel() for a in np.meshgrid(centre, centre))
    value = gpu().evaluate(
        "relative_solid_angle(d)",
        "environment",
        d=np.stack((x, y, np.ones_like(x)), axis=-1),
    )
    relative = exact.ravel() / (2.0 / size) ** 2
    assert np.abs(value / relative - 1.0).max() < 1e-3


def test_turning_is_counter_clockwise_seen_from_above():
    """After a quarter turn what was at +X is at -Z, and at +Z what was -Z
    is found at -X."""
    turned = gpu().evaluate(
        "turn_into_environment(d, vec2(0.0, 1.0))",
        "environment",
        d=np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]]),
    )
    expected = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    assert np.abs(turned - expected).max() < 1e-7


def test_a_map_becomes_a_cube_without_seams():
    image = smooth(oracle.equirectangular_directions(512, 256))
    cube = resample(image, 32, 2)
    assert np.abs(cube - smooth(texel_directions(32))).max() < 2e-3


def test_a_face_alone_is_that_of_all_six():
    image = np.random.default_rng(3).uniform(0.0, 1.0, (64, 128, 3))
    cube = resample(image, 32, 2)
    for face in range(6):
        assert np.array_equal(resample(image, 32, 2, face=face), cube[face])


def test_sampling_the_cube_gives_what_the_map_has_in_that_direction():
    """On all six axes and between: the whole way, through the hardware."""
    image = smooth(oracle.equirectangular_directions(512, 256))
    faces = resample(image, 64)
    alpha = np.ones((6, 64, 64, 1))
    cube = gpu().cube(np.concatenate((faces, alpha), axis=-1), mipmaps=False)
    # A list of one sample reads the cube in the direction of a texel.
    mirrored = draw_cube(
        "prefilter_specular.frag",
        8,
        {"environment_cube": cube},
        defines={"MOKA_SAMPLE_COUNT": 1},
        blocks={"PrefilterSamples": pack(ggx_prefilter_samples(0, 1, 64), 1)},
    )
    assert np.abs(mirrored - smooth(texel_directions(8))).max() < 4e-3


@pytest.mark.parametrize(
    ("row", "column", "subdivisions", "tolerance"),
    [
        # Samples 0.6 texels of the map apart at the equator, then half that.
        (31, 100, 2, 0.08),
        (31, 100, 4, 0.02),
        (20, 5, 2, 0.08),
        (20, 5, 4, 0.02),
        # Towards a pole the map's texels get narrower, here by eight.
        (2, 60, 16, 0.04),
    ],
)
def test_a_sun_of_one_texel_keeps_its_flux(
    row, column, subdivisions, tolerance
):
    width, height, size = 128, 64, 32
    image = np.zeros((height, width, 3))
    image[row, column] = 1e5
    cube = resample(image, size, subdivisions)
    flux = np.einsum("fyxc,yx->c", cube, cube_texel_solid_angles(size))
    solid_angles = oracle.equirectangular_solid_angles(width, height)
    expected = 1e5 * solid_angles[row, column]
    # Where half floats end is where a texel would, too.
    assert cube.max() < 65504.0
    assert flux == pytest.approx(expected, rel=tolerance)


def test_a_level_is_the_mean_of_the_texels_it_covers():
    generator = np.random.default_rng(2)
    fine = generator.uniform(0.0, 1.0, (6, 16, 16, 4))
    coarse = draw_cube(
        "downsample_cube.frag",
        8,
        {"environment_cube": gpu().cube(fine, mipmaps=False)},
    )
    weights = cube_texel_solid_angles(16)[None, :, :, None]
    weighted = (fine[..., :3] * weights).reshape(6, 8, 2, 8, 2, 3)
    total = weights.reshape(1, 8, 2, 8, 2, 1).sum(axis=(2, 4))
    expected = weighted.sum(axis=(2, 4)) / total
    assert np.abs(coarse - expected).max() < 1e-3
    mean = np.einsum("fyxc,yx->c", coarse, cube_texel_solid_angles(8))
    assert mean == pytest.approx(weighted.sum(axis=(0, 1, 2, 3, 4)), rel=1e-4)


@pytest.fixture(scope="module")
def smooth_cube():
    faces = smooth(texel_directions(64))
    alpha = np.ones((6, 64, 64, 1))
    return gpu().cube(np.concatenate((faces, alpha), axis=-1), mipmaps=True)


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.5, 1.0])
def test_uniform_radiance_stays_what_it_is(roughness):
    cube = gpu().cube(np.full((6, 64, 64, 4), 3.25), mipmaps=True)
    assert prefilter(cube, roughness) == pytest.approx(3.25, rel=1e-5)
    assert convolve(cube) == pytest.approx(3.25, rel=1e-5)


@pytest.mark.parametrize("roughness", [0.1, 0.3, 0.6, 1.0])
def test_prefiltered_radiance(smooth_cube, roughness):
    directions = texel_directions(8).reshape(-1, 3)[::7]
    expected = oracle.prefiltered(smooth, directions, roughness)
    value = prefilter(smooth_cube, roughness).reshape(-1, 3)[::7]
    # Of a range of 2, with 256 samples; their levels blur a little more
    # than the lobe does.
    assert np.abs(value - expected).max() < 0.025


def test_irradiance_is_divided_by_pi(smooth_cube):
    directions = texel_directions(8).reshape(-1, 3)[::7]
    expected = oracle.irradiance_over_pi(smooth, directions)
    value = convolve(smooth_cube).reshape(-1, 3)[::7]
    assert np.abs(value - expected).max() < 0.015


def test_the_cosine_lobe_of_a_linear_environment_is_two_thirds():
    """E / pi of radiance 1 + d.x is 1 + 2/3 n.x: an integral by hand."""
    directions = texel_directions(8)
    value = oracle.irradiance_over_pi(smooth, directions[0, 0, :1])[0, 0]
    assert value == pytest.approx(1.0 + 2.0 / 3.0 * directions[0, 0, 0, 0])


def test_a_sun_of_one_texel_makes_no_fireflies():
    """Filtered samples: neighbours differ by what the lobe says, and no
    more than half as much again; suns are taken out of most maps before.
    """
    faces = np.zeros((6, 64, 64, 4))
    faces[2, 20, 40] = 1e6
    cube = gpu().cube(faces, mipmaps=True)
    rough = prefilter(cube, 0.6, count=64, size=16)[2, :, :, 0]
    step = np.abs(np.diff(rough, axis=1)).max() / rough.max()
    assert np.isfinite(rough).all()
    assert step < 0.4
    light = convolve(cube, count=256, size=16)[2, :, :, 0]
    assert np.abs(np.diff(light, axis=1)).max() / light.max() < 0.4
    expected = 1e6 / np.pi * cube_texel_solid_angles(64)[20, 40]
    assert light.max() == pytest.approx(expected, rel=0.25)


@pytest.mark.parametrize("axis", range(6))
def test_the_background_shows_the_direction_of_each_pixel(axis):
    """A camera of 90 degrees along each axis sees what lies there."""
    forward = AXES[axis]
    up = AXES[2] if abs(forward[1]) < 0.5 else AXES[0]
    right = np.cross(forward, up)
    matrix = np.zeros((4, 4), np.float32)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 3] = right, up, forward
    image = smooth(oracle.equirectangular_directions(512, 256))
    block = matrix.T.tobytes() + np.array([2, 0, 0, 0], np.float32).tobytes()
    picture = gpu().draw(
        "background.frag",
        (32, 32),
        vertex="screen.vert",
        defines={"MOKA_SKY": 1},
        textures={"environment_map": gpu().texture(image)},
        blocks={"Background": block},
    )
    plane = (np.arange(32) + 0.5) / 16 - 1.0
    x, y = (a[..., None] for a in np.meshgrid(plane, plane))
    rays = forward + x * right + y * up
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    assert np.abs(picture[..., :3] - 2.0 * smooth(rays)).max() < 0.01
    assert (picture[..., 3] == 1.0).all()


def test_a_background_brighter_than_half_floats_stays_finite():
    picture = gpu().draw(
        "background.frag",
        (4, 4),
        vertex="screen.vert",
        defines={"MOKA_SKY": 1},
        dtype="f2",
        textures={"environment_map": gpu().texture(np.full((2, 4, 3), 1e9))},
        blocks={
            "Background": np.eye(4, dtype=np.float32).tobytes()
            + np.array([1, 0, 0, 0], np.float32).tobytes()
        },
    )
    assert np.isfinite(picture).all()
