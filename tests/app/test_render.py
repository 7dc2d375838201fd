"""moka.render and moka.run, headless, as a user calls them."""

import math
from pathlib import Path

import numpy as np
import pytest

import moka
from moka.app.application import App, GameTime
from moka.app.run import run
from moka.commands.command_list import CommandList
from moka.core.errors import ModelError, OptionError
from moka.material.material import Material
from moka.model import cube, model_of, quad, save_model
from moka.scene.camera import Camera

pytestmark = pytest.mark.gpu


def square() -> moka.Model:
    """A white unlit square that faces +Z."""
    return model_of([(quad(2.0), Material(unlit=True), np.eye(4))])


def test_an_image_of_the_built_in_scene() -> None:
    image = moka.render(size=(48, 27))
    assert image.size == (48, 27)
    assert image.pixels.shape == (27, 48, 4)
    assert image.pixels.dtype == np.float32
    assert np.isfinite(image.pixels).all()
    assert 0.05 < image.pixels[..., :3].mean() < 5
    assert image._repr_png_().startswith(b"\x89PNG")


def test_a_path_its_bytes_a_document_and_a_model_give_one_picture(
    tmp_path: Path,
) -> None:
    import pygltflib

    path = tmp_path / "cube.glb"
    model = model_of([(cube(1.0), Material(metallic_factor=0.0), np.eye(4))])
    save_model(model, path)
    sources = [path, path.read_bytes(), pygltflib.GLTF2().load(path), model]
    pictures = [
        moka.render(source, size=(32, 32), camera="orbit:30,20").pixels
        for source in sources
    ]
    for picture in pictures[1:]:
        assert np.array_equal(picture, pictures[0])


def test_pixels_are_neither_exposed_nor_tone_mapped() -> None:
    plain = moka.render(square(), size=(8, 8), environment="none")
    bright = moka.render(
        square(), size=(8, 8), environment="none", exposure=3, tone_map="aces"
    )
    assert np.array_equal(plain.pixels, bright.pixels)
    assert not np.array_equal(plain.to_display(), bright.to_display())


def test_a_colour_behind_the_model_is_in_the_pixels_too() -> None:
    for background in ("#ff0080", (1.0, 0.0, 0.2158605)):
        image = moka.render(
            square(), size=(32, 8), environment="none", background=background
        )
        np.testing.assert_allclose(
            image.pixels[0, 0], (1.0, 0.0, 0.2158605, 1.0), rtol=1e-5
        )
        assert tuple(image.to_display()[0, 0]) == (255, 0, 128, 255)
        np.testing.assert_allclose(image.pixels[4, 16], 1.0)
    clear = moka.render(square(), size=(32, 8), background="transparent")
    assert not clear.pixels[0, 0].any()


def test_what_the_gpu_shows_is_what_the_pixels_say() -> None:
    """The display bytes against NumPy's tone map of the same pixels."""
    for name in ("neutral", "aces", "agx", "reinhard", "exponential", "none"):
        image = moka.render(size=(64, 36), tone_map=name, exposure=0.5)
        again = moka.Image(image.pixels, tone_map=name, exposure=0.5)
        difference = image.to_display().astype(int) - again.to_display()
        assert np.abs(difference).max() <= 1, name


def test_a_camera_object_and_its_text_agree() -> None:
    model = square()
    camera = Camera()
    camera.frame(model.bounds(), 1.0, math.radians(40), math.radians(10))
    by_object = moka.render(model, size=(16, 16), camera=camera)
    by_text = moka.render(model, size=(16, 16), camera="orbit:40,10")
    assert np.array_equal(by_object.pixels, by_text.pixels)


def test_mistakes_raise_errors_for_people() -> None:
    with pytest.raises(ModelError, match="no such file"):
        moka.render("nothing.glb")
    with pytest.raises(OptionError, match="size"):
        moka.render(square(), size=(0, 4))
    with pytest.raises(OptionError, match="there is no camera 3"):
        moka.render(square(), camera="3")
    with pytest.raises(moka.MokaError):
        moka.render(square(), environment="nowhere.hdr")


class Spinner(App):
    """Turns a square and remembers what was called."""

    def __init__(self) -> None:
        super().__init__()
        self.calls: list[str] = []
        self.times: list[GameTime] = []

    def load(self) -> None:
        self.calls.append("load")
        self.model = self.scene.add(square())

    def update(self, time: GameTime) -> None:
        self.calls.append("update")
        self.times.append(time)
        self.model.transform.rotate_around((0, 0, 0), (0, 0, 1), time.delta)

    def draw(self, time: GameTime, commands: CommandList) -> None:
        self.calls.append("draw")
        super().draw(time, commands)

    def close(self) -> None:
        self.calls.append("close")


def test_the_loop_calls_everything_in_order() -> None:
    app = run(Spinner, headless=True, frames=3, size=(16, 12), debug=True)
    assert isinstance(app, Spinner)
    assert app.calls == ["load", *["update", "draw"] * 3, "close"]
    assert [time.frame for time in app.times] == [0, 1, 2]
    assert app.times[0].delta == 0
    assert app.times[2].total == pytest.approx(2 / 60)
    assert app.image is not None
    assert app.image.size == (16, 12)
    # Framed, since nobody placed the camera.
    assert app.image.pixels[6, 8].tolist() == [1, 1, 1, 1]


def test_reference_lighting_completes_the_last_frame() -> None:
    settings = moka.RenderSettings(
        ibl="reference", reference_samples=64, float_output=True
    )

    class Rough(Spinner):
        def load(self) -> None:
            super().load()
            self.scene.environment = moka.load_environment("sky")

    app = run(Rough, headless=True, frames=2, size=(8, 8), settings=settings)
    assert isinstance(app, Rough)
    statistics = app.renderer.lighting_statistics
    assert statistics["samples_per_pixel"] == 64
    # The world goes on by frames, however often one is drawn.
    assert app.calls.count("update") == 2
    assert app.calls.count("draw") > 2


def test_drawing_that_never_rests_ends_all_the_same() -> None:
    class Restless(Spinner):
        def draw(self, time: GameTime, commands: CommandList) -> None:
            self.camera.transform.translate((0.01, 0.0, 0.0))
            super().draw(time, commands)

    settings = moka.RenderSettings(ibl="reference", reference_samples=8)
    app = run(Restless, headless=True, size=(8, 8), settings=settings)
    assert app.image is not None


def test_an_app_can_quit_itself() -> None:
    class Quitter(Spinner):
        def update(self, time: GameTime) -> None:
            super().update(time)
            if time.frame == 2:
                self.quit()

    app = run(Quitter(), headless=True, frames=100, size=(8, 8))
    assert app.times[-1].frame == 2
    assert app.image is not None


@pytest.mark.parametrize("where", ["load", "update", "draw"])
def test_an_error_in_a_callback_ends_the_run_with_its_own_traceback(
    where: str,
) -> None:
    class Faulty(Spinner):
        pass

    def fault(*_: object) -> None:
        raise ZeroDivisionError(where)

    setattr(Faulty, where, fault)
    app = Faulty()
    with pytest.raises(ZeroDivisionError, match=where) as caught:
        run(app, headless=True, size=(8, 8))
    assert "fault" in [frame.name for frame in caught.traceback]
    assert app.calls[-1] == "close"
    assert app.device.is_closed


def test_moving_and_adding_between_frames_changes_the_picture() -> None:
    class Builder(Spinner):
        pictures: list[np.ndarray]

        def load(self) -> None:
            super().load()
            self.pictures = []
            self.camera.frame(self.scene.bounds(), 1.0)

        def update(self, time: GameTime) -> None:
            if time.frame == 1:
                self.model.transform.translate((10, 0, 0))
            if time.frame == 2:
                self.second = self.scene.add(square())
            if time.frame == 3:
                self.second.remove()
            if time.frame == 4:
                self.scene.environment = moka.load_environment("furnace")

    shown = []
    for frames in range(1, 6):
        app = run(Builder, headless=True, frames=frames, size=(9, 9))
        assert app.image is not None
        shown.append(app.image.pixels[4, 4, 0] == 1)
    assert shown == [True, False, True, False, True]
