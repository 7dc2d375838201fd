"""Every example runs headless, and its picture shows what it claims."""

import ast
import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

import moka

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
    names = {
        path.stem
        for path in EXAMPLES.iterdir()
        if path.suffix in (".py", ".ipynb")
    }
    tested = {
        name.removeprefix("test_").partition("__")[0]
        for name in globals()
        if name.startswith("test_") and "__" in name
    }
    assert names == tested - {"gallery"}


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


def test_ibl_by_roughness__truth_is_near() -> None:
    example = load("ibl_by_roughness")
    example.MODES[2]["reference_samples"] = 64
    split, filtered, truth = (
        luminance(image.pixels) for image in example.rows((140, 24))
    )
    # Wide lobes, where the sky is smooth: from the middle to the right.
    rough = np.s_[:, 70:]
    for approximation in (split, filtered):
        error = np.abs(approximation - truth)[rough].mean()
        assert error < 0.05 * truth[rough].mean()
    assert example.render((70, 36)).size == (70, 36)


def test_many_objects__are_few_draws() -> None:
    example = load("many_objects")
    app = example.run((96, 54))
    counts = app.renderer.statistics.counts
    assert counts["objects"] == 10_000
    assert 0 < counts["visible"] <= 10_000
    assert counts["permutations"] == 1
    assert luminance(app.image.pixels).std() > 0.02


def test_transparent_order__is_right_from_both_sides() -> None:
    example = load("transparent_order")
    pixels = example.render((192, 72)).pixels[..., :3]
    front, back = pixels[:, :96], pixels[:, 96:]
    # Blue glass is in front of one picture, red glass of the other.
    assert nearest_tint(front) == 2
    assert nearest_tint(back) == 0


def nearest_tint(pixels: NDArray[np.float32]) -> int:
    """The channel that is strongest on the whole, background aside."""
    difference = pixels - pixels[0, 0]
    return int(np.argmax(difference.sum(axis=(0, 1))))


def test_animated_character__walks_and_stands() -> None:
    example = load("animated_character")
    first, later = (
        example.render((64, 64), frames=frames).pixels for frames in (2, 20)
    )
    assert np.abs(luminance(first) - luminance(later)).max() > 0.1

    app = example.AnimatedCharacter()
    moka.run(app, headless=True, frames=2, size=(16, 16))
    player = app.character.animations
    assert player.names == ["walk", "stand"]
    app.next_animation()
    assert player.current.animation == 1


def test_turntable__writes_a_moving_picture(tmp_path: Path) -> None:
    example = load("turntable")
    path = tmp_path / "turntable.webp"
    example.write(str(path), size=(48, 36), frames=4)
    with PillowImage.open(path) as moving:
        assert moving.n_frames == 4
        assert moving.size == (48, 36)
    assert luminance(example.render((48, 36)).pixels).std() > 0.02


def test_dataset__has_the_truth_beside_the_picture(tmp_path: Path) -> None:
    example = load("dataset")
    (image,) = example.pictures(None, 1, (48, 36))
    assert set(image.layers) == set(example.AOVS)
    hit = image.layers["object-id"] > 0
    assert 0.02 < hit.mean() < 0.9
    length = np.linalg.norm(image.layers["normal"][hit], axis=1)
    np.testing.assert_allclose(length, 1.0, atol=1e-5)
    image.save(tmp_path / "0000.exr")
    assert example.render((64, 48)).size == (64, 48)
    pitches = [float(view.split(",")[1]) for view in example.views(20)]
    assert 0 < min(pitches) < max(pitches) < 90


def test_points_and_lines__have_their_own_colours() -> None:
    example = load("points_and_lines")
    pixels = example.render((160, 90)).pixels[..., :3]
    assert (pixels.min(axis=2) > 0.95).any()  # the white line
    background = pixels[0, 0]
    drawn = np.abs(pixels - background).max(axis=2) > 0.1
    for channel in range(3):
        others = np.delete(pixels, channel, axis=2).max(axis=2)
        assert (drawn & (pixels[..., channel] > 2 * others)).any()


def test_own_shader__has_two_permutations() -> None:
    example = load("own_shader")
    shown = example.render((160, 90)).to_display()[..., :3].astype(int)
    plain, striped = shown[:, :80], shown[:, 80:]
    # White stripes are grey where they are lit; paint never is.
    assert not is_grey(plain).any()
    assert is_grey(striped).mean() > 0.05


def test_embedding__keeps_what_the_host_has_set() -> None:
    example = load("embedding")
    shown = example.render((160, 90)).to_display()
    # The host's frame, drawn with its own blending and texture after moka.
    assert not shown[[0, -1], :, :3].any()
    assert (shown[..., 3] == 255).all()
    # Its wall, of two colours, shows through around the scene.
    wall = np.array([[0.1, 0.2, 0.4], [0.9, 0.6, 0.2]]) * 255
    distance = np.abs(shown[..., None, :3] - wall).max(axis=-1)
    is_wall = distance.min(axis=-1) < 2
    assert is_wall[10].mean() > 0.8
    assert 0.05 < 1 - is_wall[20:70, 20:140].mean() < 0.9


def test_notebook__shows_pictures_and_a_viewer() -> None:
    pytest.importorskip("jupyter_rfb", reason="jupyter_rfb is not installed")
    text = (EXAMPLES / "notebook.ipynb").read_text(encoding="utf-8")
    cells = [
        "".join(cell["source"])
        for cell in json.loads(text)["cells"]
        if cell["cell_type"] == "code"
    ]
    names: dict[str, Any] = {}
    picture, viewer, _, changed = (run_cell(cell, names) for cell in cells)
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert viewer.get_frame().shape == (270, 480, 4)
    assert changed.size == picture.size
    difference = luminance(changed.pixels) - luminance(picture.pixels)
    assert np.abs(difference).mean() > 0.05
    viewer.close()


def run_cell(source: str, names: dict[str, Any]) -> Any:
    """Run a cell; the value of its last line, if that has one."""
    *statements, last = ast.parse(source).body
    if not isinstance(last, ast.Expr):
        exec(compile(source, "cell", "exec"), names)
        return None
    module = ast.Module(statements, type_ignores=[])
    exec(compile(module, "cell", "exec"), names)
    expression = ast.Expression(last.value)
    return eval(compile(expression, "cell", "eval"), names)


def is_grey(pixels: NDArray[np.int_]) -> NDArray[np.bool_]:
    """Bright pixels without a colour."""
    return (np.ptp(pixels, axis=2) < 12) & (pixels.min(axis=2) > 110)


def test_gallery__has_every_example() -> None:
    docs = EXAMPLES.parent / "docs"
    page = (docs / "gallery.md").read_text(encoding="utf-8")
    for path in EXAMPLES.glob("*.py"):
        assert f"images/gallery/{path.stem}.png" in page, "run make gallery"
        assert f"examples/{path.name}" in page
        assert (docs / "images" / "gallery" / f"{path.stem}.png").exists()
