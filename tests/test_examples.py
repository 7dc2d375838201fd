"""Every example runs headless, and its picture shows what it claims."""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

pytestmark = pytest.mark.gpu


def load(name: str) -> ModuleType:
    """Import an example from its file."""
    path = EXAMPLES / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"examples.{name}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def luminance(pixels: NDArray[np.float32]) -> NDArray[np.float64]:
    """Rec.709 luminance (H, W) of linear pixels (H, W, 4)."""
    return np.asarray(pixels[..., :3] @ (0.2126, 0.7152, 0.0722))


def test_every_example_is_tested() -> None:
    names = {path.stem for path in EXAMPLES.glob("*.py")}
    tested = {
        name.removeprefix("test_").partition("__")[0]
        for name in globals()
        if name.startswith("test_") and "__" in name
    }
    assert names == tested


def test_own_command_list__blends_from_back_to_front() -> None:
    example = load("own_command_list")
    pixels = example.render((64, 36)).pixels
    assert pixels.shape == (36, 64, 4)
    np.testing.assert_allclose(pixels[0, 0], example.BACKGROUND, atol=1e-6)
    expected = np.array(example.BACKGROUND[:3])
    for red, green, blue, alpha in example.COLOURS[::-1].tolist():
        colour = np.array([red, green, blue])
        expected = alpha * colour + (1 - alpha) * expected
    np.testing.assert_allclose(pixels[18, 32, :3], expected, atol=1e-6)
    # The nearest pane alone covers its own lower left corner: the third
    # reaches least far down, and row 0 is at the top.
    nearest = 0.5 * example.COLOURS[0, :3] + 0.5 * np.array(
        example.BACKGROUND[:3]
    )
    np.testing.assert_allclose(pixels[29, 12, :3], nearest, atol=1e-6)


def test_material_grid__shows_roughness_and_metalness() -> None:
    example = load("material_grid")
    image = example.render((280, 166))
    assert image.size == (280, 166)
    light = luminance(image.pixels)
    assert np.isfinite(light).all()
    # The corners are background, the same in every picture.
    assert np.ptp(light[:4, :4]) < 1e-6
    spheres = np.abs(light - light[0, 0]) > 1e-4
    assert 0.3 < spheres.mean() < 0.8
    # Mirrors on the left show the soft boxes, matt ones on the right not.
    assert contrast(light, spheres, 0.0, 0.3) > 1.5 * contrast(
        light, spheres, 0.7, 1.0
    )
    # Orange metal reflects orange only, plastic also reflects white.
    top, bottom = image.pixels[:40], image.pixels[-40:]
    assert blue_share(top) < 0.75 * blue_share(bottom)


def contrast(
    light: NDArray[np.float64],
    spheres: NDArray[np.bool_],
    left: float,
    right: float,
) -> float:
    """Deviation by mean of the spheres between two shares of the width."""
    width = light.shape[1]
    part = slice(int(left * width), int(right * width))
    values = light[:, part][spheres[:, part]]
    return float(values.std() / values.mean())


def blue_share(pixels: NDArray[np.float32]) -> float:
    """Blue by red, summed over what is brighter than the background."""
    shown = luminance(pixels) > 0.05
    return float(pixels[shown, 2].sum() / pixels[shown, 0].sum())


def test_brdf_comparison__tells_the_models_apart() -> None:
    example = load("brdf_comparison")
    gltf, single, karis, phong = (
        luminance(image.pixels) for image in example.rows((140, 24))
    )
    matt = np.s_[6:18, 125:135]
    mirror = np.s_[6:18, 5:15]
    # Multiple scattering matters where the surface is rough, and only there.
    assert gltf[matt].mean() > 1.5 * single[matt].mean()
    assert gltf[mirror].mean() == pytest.approx(single[mirror].mean(), 0.02)
    for other in (karis, phong):
        assert np.abs(other - single).max() > 0.01
    assert example.render((140, 96)).size == (140, 96)


def test_hello_model__turns_its_model() -> None:
    example = load("hello_model")
    first = example.render((96, 54)).pixels
    later = example.render((96, 54), frames=30).pixels
    assert first.shape == later.shape == (54, 96, 4)
    assert luminance(first).std() > 0.05
    assert np.abs(luminance(first) - luminance(later)).mean() > 0.01
