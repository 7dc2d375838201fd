"""Filtered lighting: nearer to the reference where split-sum is far."""

from functools import cache

import numpy as np
import pytest

from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment, load_environment
from tests.support.oracles import reference as oracle
from tests.support.patches import draw_patches, tilted

pytestmark = pytest.mark.gpu

WHITE = (1.0, 1.0, 1.0)
ROUGHNESSES = (0.2, 0.4, 0.6, 1.0)
NORMALS = np.concatenate(
    [tilted([0.6, 0.3, 0.1], azimuth) for azimuth in (0.1, 1.3, 2.9, 4.4)]
)


def metals(*roughnesses: float) -> list[oracle.Material]:
    return [oracle.Material(WHITE, 1.0, value) for value in roughnesses]


def draw(
    device: GraphicsDevice,
    environment: Environment,
    roughnesses: tuple[float, ...],
    normals: np.ndarray,
    **settings: object,
) -> np.ndarray:
    """Radiance (roughnesses, normals, 3) of white metals, no suns."""
    options = {"multiscatter": False} | settings
    if options["ibl"] != "reference":
        options["suns"] = "off"
    pixels = draw_patches(
        device, environment, normals, metals(*roughnesses), **options
    )
    return pixels.mean(axis=2)


@cache
def sky() -> Environment:
    """The built-in sky without its sun, a quarter of the size."""
    whole = load_environment("sky")
    assert whole is not None
    height, width, _ = whole.pixels.shape
    pixels = whole.pixels.reshape(height // 4, 4, width // 4, 4, 3)
    return Environment(pixels.mean(axis=(1, 3)))


def test_grazing_reflections_come_back(egl_device: GraphicsDevice) -> None:
    truth = draw(
        egl_device,
        sky(),
        ROUGHNESSES,
        NORMALS,
        ibl="reference",
        reference_samples=512,
    )
    errors = {}
    for ibl, count in (("split-sum", 1), ("filtered", 4), ("filtered", 16)):
        drawn = draw(
            egl_device,
            sky(),
            ROUGHNESSES,
            NORMALS,
            ibl=ibl,
            ibl_samples=count,
        )
        relative = (drawn - truth) / truth.mean(axis=-1, keepdims=True)
        # By n.v, which is every third normal.
        square = (relative**2).reshape(len(ROUGHNESSES), 4, 3, 3)
        errors[ibl, count] = np.sqrt(square.mean(axis=(0, 1, 3)))
    # Columns are n.v of 0.6, 0.3 and 0.1.
    assert (errors["filtered", 16] < errors["split-sum", 1]).all()
    assert errors["filtered", 16][1] < 0.6 * errors["split-sum", 1][1]
    assert errors["filtered", 16][2] < 0.5 * errors["split-sum", 1][2]
    assert errors["filtered", 16].mean() < errors["filtered", 4].mean()
    assert errors["filtered", 16].max() < 0.045


@pytest.mark.parametrize(
    ("roughnesses", "cosines"),
    [((0.0, 0.05), [0.9, 0.5, 0.1]), ((0.3, 0.7, 1.0), [1.0, 0.93, 0.86])],
)
def test_smooth_and_facing_surfaces_are_left_alone(
    egl_device: GraphicsDevice,
    roughnesses: tuple[float, ...],
    cosines: list[float],
) -> None:
    split_sum, filtered = (
        draw(egl_device, sky(), roughnesses, tilted(cosines), ibl=ibl)
        for ibl in ("split-sum", "filtered")
    )
    assert np.array_equal(split_sum, filtered)


def test_no_step_shows_where_samples_begin(egl_device: GraphicsDevice) -> None:
    """Along n.v and along roughness, across the bounds.

    In what the samples add: along n.v the sky itself changes.
    """
    cosines = np.linspace(0.9, 0.65, 60)
    axis = np.array([np.cos(0.7), np.sin(0.7)])
    normals = np.concatenate(
        (np.sqrt(1 - cosines**2)[:, None] * axis, cosines[:, None]), axis=1
    )
    along, without = (
        draw(egl_device, sky(), (0.5,), normals, ibl=ibl)[0]
        for ibl in ("filtered", "split-sum")
    )
    steps = np.abs(np.diff(along / without, axis=0))
    assert steps.max() < 0.02
    roughnesses = tuple(np.linspace(0.03, 0.2, 60))
    across = draw(
        egl_device, sky(), roughnesses, tilted([0.2]), ibl="filtered"
    )[:, 0]
    steps = np.abs(np.diff(across, axis=0)) / across[1:]
    assert steps.max() < 0.05


@pytest.mark.parametrize("brdf", ["gltf", "karis", "blinn-phong"])
def test_uniform_light_has_no_difference(
    egl_device: GraphicsDevice, brdf: str
) -> None:
    """A map of one radiance, and one texel for all directions."""
    for shape in ((16, 32, 3), (1, 1, 3)):
        environment = Environment(np.full(shape, 0.7, np.float32))
        split_sum, filtered = (
            draw(
                egl_device,
                environment,
                ROUGHNESSES,
                NORMALS[:3],
                ibl=ibl,
                ibl_samples=5,
                brdf=brdf,
            )
            for ibl in ("split-sum", "filtered")
        )
        assert filtered == pytest.approx(split_sum, rel=1e-5)


def test_light_is_never_negative(egl_device: GraphicsDevice) -> None:
    """A lamp of few texels in the dark, fewer samples than it needs."""
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[14:16, 40:42] = 100.0
    drawn = draw(
        egl_device,
        Environment(pixels),
        ROUGHNESSES,
        NORMALS,
        ibl="filtered",
        ibl_samples=2,
    )
    assert np.isfinite(drawn).all()
    assert drawn.min() >= 0.0
