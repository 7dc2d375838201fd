"""Reference lighting against float64 integrals over the whole map."""

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import AlphaMode, Material
from moka.model.geometry import quad, sphere
from moka.model.lights import LightKind, PunctualLight
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from tests.support.gpu import gpu
from tests.support.oracles import reference as oracle
from tests.support.oracles.directions import spherical
from tests.support.patches import (
    VIEW,
    draw_patches,
    expected_patches,
    sunny,
    tilted,
)
from tests.support.pictures import (
    draw_radiance,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

GOLD = (1.0, 0.77, 0.34)
CLAY = (0.8, 0.3, 0.2)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
MATERIALS = [
    oracle.Material(colour, metalness, roughness)
    for colour, metalness in ((GOLD, 1.0), (CLAY, 0.0))
    for roughness in (0.0, 0.1, 0.4, 1.0)
]
NORMALS = tilted([1.0, 0.7, 0.4, 0.1])


def test_spheres_under_a_sun_are_what_the_integral_says(
    egl_device: GraphicsDevice,
) -> None:
    """The aims of the reference: 0.015 mean RMSE, 0.004 median."""
    pixels = sunny()
    drawn = draw_patches(
        egl_device,
        Environment(pixels),
        NORMALS,
        MATERIALS,
        ibl="reference",
        reference_samples=2048,
        multiscatter=False,
    )
    expected = expected_patches(pixels, NORMALS, MATERIALS, multiscatter=False)
    difference = drawn - expected[:, :, np.newaxis]
    error = np.sqrt(np.mean(difference**2, axis=(2, 3)))
    assert (error / expected.mean(axis=-1)).mean() < 0.015
    relative = np.abs(difference) / expected[:, :, np.newaxis]
    assert np.median(relative) < 0.004
    # The mean of the pixels says whether it is biased.
    bias = np.abs(drawn.mean(axis=2) / expected - 1.0)
    assert bias.max() < 0.01
    # Roughness 0 is the mirror image, with no noise at all.
    assert relative[[0]].max() < 2e-3


def test_energy_compensation_is_that_of_split_sum(
    egl_device: GraphicsDevice,
) -> None:
    pixels = sunny(sun=0.0)
    materials = [MATERIALS[2], MATERIALS[6]]
    drawn = draw_patches(
        egl_device,
        Environment(pixels),
        NORMALS,
        materials,
        ibl="reference",
        reference_samples=512,
    )
    expected = expected_patches(pixels, NORMALS, materials)
    assert drawn.mean(axis=2) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("brdf", ["gltf", "karis", "blinn-phong"])
@pytest.mark.parametrize("diffuse", ["lambert", "oren-nayar", "burley"])
def test_uniform_light_gives_what_split_sum_gives(
    egl_device: GraphicsDevice, brdf: str, diffuse: str
) -> None:
    """There split-sum is exact, whatever the BRDF."""
    environment = Environment(np.ones((4, 8, 3), np.float32))
    materials = [
        oracle.Material(colour, metalness, roughness)
        for colour, metalness in ((GOLD, 1.0), (CLAY, 0.0))
        for roughness in (0.3, 0.8)
    ]
    reference, split_sum = (
        draw_patches(
            egl_device,
            environment,
            tilted([0.9, 0.3]),
            materials,
            brdf=brdf,
            diffuse=diffuse,
            ibl=ibl,
            reference_samples=256,
        ).mean(axis=2)
        for ibl in ("reference", "split-sum")
    )
    # Burley's albedo is exact, its table and nine coefficients nearly so.
    assert reference == pytest.approx(split_sum, rel=0.01)


def test_few_reflections_fall_below_the_surface() -> None:
    """Without the bound on visible normals 0.26, 0.27 and 0.5 of them do."""
    points = np.random.default_rng(3).random((20_000, 2))
    for cosine, alpha in ((0.9, 0.5), (0.2, 0.3), (0.5, 1.0)):
        drawn = gpu().evaluate(
            "sample_visible_reflection(point, view, alpha)",
            "visible_reflection",
            point=points,
            view=spherical(cosine, 0.0)[None],
            alpha=alpha,
        )
        assert np.mean(drawn[:, 2] <= 0.0) < 0.2


def test_sequences_are_stratified_from_any_start() -> None:
    """256 points, 16 strata: every stratum of either axis has its share."""
    index = np.arange(256)
    for start in (0, 123456789):
        points = gpu().evaluate(
            f"sequence(uint(i + 0.5), uvec2({start}u, {start}u * 7u))",
            "sequence",
            i=index,
        )
        assert (points >= 0.0).all()
        assert (points < 1.0).all()
        for axis in range(2):
            counts = np.bincount((points[:, axis] * 16).astype(int))
            assert np.abs(counts - 16).max() <= 2


def test_the_estimated_error_is_that_of_the_picture(
    egl_device: GraphicsDevice,
) -> None:
    """Of one rough patch that fills the picture, all pixels alike."""
    pixels = sunny()
    material = Material(
        base_colour_factor=(*CLAY, 1.0),
        metallic_factor=0.0,
        roughness_factor=0.5,
    )
    scene = scene_of([(quad(2.5), material, np.eye(4))], Environment(pixels))
    settings = RenderSettings(
        ibl="reference", reference_samples=512, float_output=True
    )
    picture, statistics = sample(egl_device, scene, settings)
    truth = oracle.reflected(
        oracle.Surroundings(pixels),
        VIEW,
        VIEW,
        oracle.Material(CLAY, 0.0, 0.5),
        multiscatter=True,
    )
    error = picture[..., :3] @ LUMINANCE / (truth @ LUMINANCE) - 1.0
    assert statistics["samples_per_pixel"] == 512
    assert statistics["estimated_error"] == pytest.approx(error.std(), rel=0.25)


def test_sampling_stops_where_the_error_is_small_enough(
    egl_device: GraphicsDevice,
) -> None:
    """A rough sphere needs more than the plain sky around it."""
    material = Material(metallic_factor=0.0, roughness_factor=0.6)
    environment = Environment(np.tile(sunny()[:, :1], (1, 64, 1)))
    scene = scene_of([(sphere(0.4, 32, 16), material, np.eye(4))], environment)
    aim = 0.01
    settings = RenderSettings(ibl="reference", max_error=aim, float_output=True)
    picture, statistics = sample(egl_device, scene, settings, (160, 160))
    assert statistics["estimated_error"] <= aim
    # Tiles of sky stop at the fewest batches, those of the sphere do not.
    assert 128 < statistics["samples_per_pixel"] < 8192
    more = RenderSettings(
        ibl="reference", reference_samples=1024, float_output=True
    )
    truth, _ = sample(egl_device, scene, more, (160, 160))
    inside = np.zeros((160, 160), bool)
    inside[64:96, 64:96] = True
    drawn, true = (some[inside][:, :3] @ LUMINANCE for some in (picture, truth))
    error = np.sqrt(np.mean((drawn / true - 1.0) ** 2))
    assert error < 1.5 * aim


def test_edges_are_smooth_and_the_picture_stays(
    egl_device: GraphicsDevice,
) -> None:
    """Frames see other points of a pixel: coverage comes out as area."""
    dark = Material(base_colour_factor=(0, 0, 0, 1))
    scene = scene_of(
        [(quad(1.0), dark, np.eye(4))],
        Environment.uniform((1.0, 1.0, 1.0)),
        "transparent",
    )
    # The quad, 1 wide in a view of 2, ends 0.3 into a pixel of 1 / 8.
    camera = square_camera()
    camera.transform.translate((0.0375, 0.0, 0.0))
    picture = draw_radiance(
        egl_device, scene, camera, (16, 16), ibl="reference"
    )
    row = picture[8, :, 3]
    assert row[4:11] == pytest.approx(1.0)
    assert row[3] == pytest.approx(0.3, abs=0.03)
    assert row[11] == pytest.approx(0.7, abs=0.03)
    assert row[12:] == pytest.approx(0.0)


def test_a_moved_camera_starts_again(egl_device: GraphicsDevice) -> None:
    environment = Environment(sunny())
    scene = scene_of([], environment)
    camera = square_camera()
    renderer = Renderer(
        egl_device,
        (16, 16),
        RenderSettings(ibl="reference", reference_samples=16),
    )
    counts = []
    for step in range(2):
        camera.transform.translate((0.1 * step, 0.0, 0.0))
        frames = 0
        while True:
            commands = CommandList()
            renderer.draw(scene, camera, commands)
            egl_device.submit(commands).wait()
            frames += 1
            if renderer.is_complete:
                break
        counts.append(frames)
    # Once finished, nothing is sampled any more.
    renderer.draw(scene, camera, CommandList())
    assert renderer.is_complete
    renderer.close()
    assert counts == [16, 16]


def sample(
    device: GraphicsDevice,
    scene: object,
    settings: RenderSettings,
    size: tuple[int, int] = (32, 32),
) -> tuple[np.ndarray, dict]:
    """Draw until complete; radiance, and what the statistics say."""
    renderer = Renderer(device, size, settings)
    try:
        commands = CommandList()
        renderer.draw(scene, square_camera(), commands)
        while not renderer.is_complete:
            device.submit(commands).wait()
            commands = CommandList()
            renderer.draw(scene, square_camera(), commands)
        radiance = renderer.read_radiance(commands)
        device.submit(commands).wait()
        assert radiance.data is not None
        return radiance.data[::-1], renderer.lighting_statistics
    finally:
        renderer.close()


def test_the_environment_turns_and_dims_as_in_split_sum(
    egl_device: GraphicsDevice,
) -> None:
    """By whole texels, so that a rolled map is the same environment."""
    pixels = sunny(16)
    rolled = np.roll(pixels, 5, axis=1)
    turned, moved = (
        draw_patches(
            egl_device,
            Environment(some),
            NORMALS,
            MATERIALS[::2],
            ibl="reference",
            reference_samples=256,
            **scene,
        ).mean(axis=2)
        for some, scene in (
            (
                pixels,
                {
                    # u grows as the environment turns clockwise.
                    "environment_rotation": -5 / 32 * 2 * np.pi,
                    "environment_intensity": 0.5,
                },
            ),
            (0.5 * rolled, {}),
        )
    )
    assert turned[0] == pytest.approx(moved[0], rel=1e-3)
    assert turned == pytest.approx(moved, rel=0.02)


def test_lights_emission_and_blending_are_unchanged(
    device: GraphicsDevice,
) -> None:
    """Without an environment the modes differ by nothing.

    The first frame looks through the middle of each pixel.
    """
    glass = Material(
        base_colour_factor=(0.2, 0.5, 0.8, 0.5),
        alpha_mode=AlphaMode.BLEND,
        emissive_factor=(0.1, 0.2, 0.0),
        roughness_factor=0.4,
    )
    wall = Material(base_colour_factor=(0.8, 0.8, 0.8, 1.0), metallic_factor=0)
    lamp = PunctualLight(LightKind.POINT, (1.0, 0.9, 0.8), 20.0)
    scene = scene_of(
        [
            (quad(3.0), wall, placed_at(z=-1)),
            (quad(3.0), glass, np.eye(4)),
        ],
        None,
        "transparent",
        lights=[(lamp, placed_at(0.3, 0.2, 2.0))],
    )
    reference, split_sum = (
        draw_radiance(
            device,
            scene,
            square_camera(),
            (16, 16),
            ibl=ibl,
            reference_samples=1,
        )
        for ibl in ("reference", "split-sum")
    )
    assert reference.max() > 0.1
    assert reference == pytest.approx(split_sum, rel=1e-6)
