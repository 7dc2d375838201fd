"""The viewer in a real window, with a person at mouse and keyboard."""

import io
import math
import shlex
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as PillowImage

import moka
from moka.app.events import DropEvent
from moka.app.keys import MouseButton
from moka.app.render_request import RenderRequest
from moka.cli.main import main
from moka.commands.command_list import CommandList
from moka.core import resources
from moka.core.decode import decode_image
from moka.core.encoded_image import EncodedImage
from moka.core.radiance_hdr import write_radiance_hdr
from moka.graphics.shader_source import forget_shaders
from moka.lighting.lighting_maker import LightingMaker
from moka.material.material import Material, Texture
from moka.model import cube, model_of, save_model, sphere
from moka.model.cameras import Perspective
from moka.renderer import geometry
from moka.ui.picture_command import picture_command
from moka.ui.viewer import Viewer
from tests.support.display import running_display
from tests.support.person import Person

pytest.importorskip("imgui_bundle")
pytestmark = [pytest.mark.window, pytest.mark.gpu]

SIZE = (400, 300)


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    glfw = pytest.importorskip("glfw")
    with running_display() as name:
        yield name
        glfw.terminate()


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "cube.glb"
    material = Material(
        base_colour_factor=(1, 0.1, 0.05, 1), metallic_factor=0.0
    )
    save_model(model_of([(cube(1.0), material, np.eye(4))]), path)
    return path


@pytest.fixture
def watch(
    display: str, model: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Callable[[Callable[[Person, Viewer], None]], Viewer]:
    """Runs the viewer while somebody does as a story says."""
    monkeypatch.chdir(tmp_path)

    def run(story: Callable[[Person, Viewer], None]) -> Viewer:
        viewer = Viewer(RenderRequest(source=model, environment="furnace"))

        def begin(person: Person) -> None:
            person.wait("the model", lambda: viewer.model is not None)
            story(person, viewer)

        person = Person(viewer, display, begin)
        person.come()
        try:
            moka.run(viewer, size=SIZE, vsync=False, debug=True, cache=False)
        finally:
            person.leave()
        return viewer

    return run


Watch = Callable[[Callable[[Person, Viewer], None]], Viewer]


def is_red(pixels: np.ndarray) -> np.ndarray:
    red, green, blue = (pixels[..., i].astype(int) for i in range(3))
    return (red > 150) & (red > green + 60) & (red > blue + 60)


def test_it_shows_the_model_beside_its_panels(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        box = (0, 0, *SIZE)
        person.wait("a picture", lambda: is_red(person.look(box)).any())
        found = is_red(person.look(box))
        column = viewer.renderer.size[0]
        assert 0 < column < SIZE[0]
        assert not found[:, column:].any()
        rows, columns = np.nonzero(found)
        # In the middle of what is left.
        assert abs(columns.mean() - column / 2) < 5
        assert abs(rows.mean() - SIZE[1] / 2) < 20
        person.act("key h")
        person.wait(
            "all of the window", lambda: viewer.renderer.size[0] == SIZE[0]
        )

    watch(story)


def test_drag_wheel_and_keys_move_the_camera(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        controls = viewer.controls
        yaw, pitch = controls.yaw, controls.pitch
        person.act("mousemove 80 150 mousedown 1")
        person.act("mousemove 110 165 mouseup 1")
        person.wait("an orbit", lambda: controls.yaw < yaw)
        assert controls.pitch > pitch

        distance = controls.distance
        person.act("click 4")
        person.wait("a zoom", lambda: controls.distance < distance)

        target = controls.target.copy()
        person.act("mousemove 80 150 mousedown 3")
        person.act("mousemove 100 150 mouseup 3")
        person.wait("a pan", lambda: bool((controls.target != target).any()))

        person.act("key Home")
        person.wait("everything", lambda: bool(np.allclose(controls.target, 0)))
        before = controls.position
        person.act("keydown w")
        person.wait(
            "a flight",
            lambda: float(np.abs(controls.position - before).max()) > 0.05,
        )
        person.act("keyup w")

    watch(story)


def test_keys_open_help_save_the_picture_and_close(
    watch: Watch, tmp_path: Path
) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        person.act("mousemove 80 250 key F1")
        person.wait("help", lambda: viewer.shows_help)
        person.act("key F1")
        person.wait("no help", lambda: not viewer.shows_help)
        person.act("key F12")
        saved = tmp_path / "moka.png"
        person.wait("a file", saved.exists)
        person.act("key ctrl+c")
        assert viewer.window is not None
        person.act("key Escape")
        person.wait("the end", lambda: viewer.quits)

    viewer = watch(story)
    assert viewer.error is None
    with PillowImage.open(tmp_path / "moka.png") as picture:
        assert picture.size == viewer.renderer.size
        assert is_red(np.asarray(picture.convert("RGB"))).any()


def test_what_cannot_be_opened_is_told_and_changes_nothing(
    watch: Watch, tmp_path: Path
) -> None:
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF no more")

    def story(person: Person, viewer: Viewer) -> None:
        shown = viewer.model
        for path in (broken, tmp_path / "text.txt", tmp_path / "no.hdr"):
            viewer.error = None
            viewer.event(DropEvent((str(path),)))
            viewer.request_redraw()
            person.wait("an error", lambda: viewer.error is not None)
            assert viewer.error is not None
            assert path.name in viewer.error
        assert viewer.model is shown

    watch(story)


def test_a_still_window_draws_nothing(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        drawn = []
        draw = viewer.draw
        viewer.draw = lambda *given: (drawn.append(1), draw(*given))[1]  # type: ignore[method-assign]
        person.wait("rest", lambda: not viewer._settling)
        time.sleep(0.5)
        before = len(drawn)
        time.sleep(1.0)
        assert len(drawn) <= before + 1

    watch(story)


def test_a_click_selects_and_two_make_a_pivot(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        box = (0, 0, *SIZE)
        person.wait("a picture", lambda: is_red(person.look(box)).any())
        person.act(f"mousemove {viewer.renderer.size[0] // 2} 150 click 1")
        person.wait("a selection", lambda: viewer.selection == 0)
        person.act("mousemove 5 5 click 1")
        person.wait("nothing selected", lambda: viewer.selection is None)

        x = viewer.renderer.size[0] // 2 + 20
        person.act(f"mousemove {x} 140 click --repeat 2 --delay 20 1")
        person.wait(
            "a pivot", lambda: bool(np.abs(viewer.controls.target).max() > 0.1)
        )
        # On the surface of the cube, whose edges are 1.
        assert np.abs(viewer.controls.target).max() == pytest.approx(
            0.5, abs=1e-3
        )

    watch(story)


def test_a_model_that_changes_is_read_again_from_where_one_stands(
    watch: Watch, model: Path
) -> None:
    pytest.importorskip("watchfiles")

    def story(person: Person, viewer: Viewer) -> None:
        box = (0, 0, *SIZE)
        person.wait("a picture", lambda: is_red(person.look(box)).any())
        viewer.controls.zoom(3, viewer.camera)
        distance = viewer.controls.distance
        green = Material(
            base_colour_factor=(0.05, 1, 0.1, 1), metallic_factor=0.0
        )
        changed = model_of([(cube(1.0), green, np.eye(4))])

        def is_green() -> bool:
            if is_red(person.look(box)).any():
                save_model(changed, model)  # The watch may be beginning.
                return False
            return True

        person.wait("another picture", is_green)
        assert viewer.controls.distance == distance
        model.write_bytes(b"half a file")
        person.wait("an error", lambda: viewer.error is not None)
        assert viewer.model is not None

    watch(story)


def test_shaders_that_change_are_compiled_again(
    watch: Watch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A broken one is told, and the picture stays."""
    pytest.importorskip("watchfiles")
    shaders = tmp_path / "shaders"
    shutil.copytree(resources.shader_folder(), shaders)
    monkeypatch.setattr(resources, "_folder", lambda _: shaders)
    shader = shaders / "surface.frag"
    text = shader.read_text()
    end = text.rindex("}")

    def story(person: Person, viewer: Viewer) -> None:
        box = (0, 0, *SIZE)
        person.wait("a picture", lambda: is_red(person.look(box)).any())

        def broken() -> bool:
            shader.write_text(text[:end] + "    nonsense;\n}\n")
            time.sleep(0.5)
            return viewer.error is not None

        person.wait("an error", broken)
        assert viewer.error is not None
        assert "surface.frag:" in viewer.error
        assert "nonsense" in viewer.error
        assert is_red(person.look(box)).any()
        shader.write_text(text[:end] + "    radiance.rgb = radiance.bgr;\n}\n")
        person.wait("blue", lambda: not is_red(person.look(box)).any())
        assert viewer.error is None

    try:
        watch(story)
    finally:
        forget_shaders()


def test_another_picture_stands_beside_it(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        box = (0, 0, *SIZE)
        person.wait("a picture", lambda: is_red(person.look(box)).any())
        width = viewer.renderer.size[0]
        before = person.look(box)[:, :width].copy()
        # Light that surfaces reflect at their face is not red.
        viewer.comparison.choice = "specular light"
        viewer.request_redraw()
        half = width // 2

        def is_split() -> bool:
            found = is_red(person.look(box))
            return (
                found[:, : half - 4].any()
                and not found[:, half + 4 : width].any()
            )

        person.wait("a grey half", is_split)
        yaw = viewer.controls.yaw

        def has_settled(x: int, *, held: bool) -> bool:
            mouse = viewer.input.mouse
            return (
                mouse.position == (x, 100)
                and mouse.is_down(MouseButton.LEFT) == held
                and not viewer._settling
            )

        # Panels see one change of the pointer in a frame, as people make
        # them.
        for action, x, held in (
            (f"mousemove {half} 100", half, False),
            ("mousedown 1", half, True),
            (f"mousemove {width - 40} 100", width - 40, True),
            (f"mousemove {width - 20} 100", width - 20, True),
            ("mouseup 1", width - 20, False),
        ):
            person.act(action)
            person.wait(action, partial(has_settled, x, held=held))
        person.wait("a drag", lambda: viewer.comparison.divider > 0.8)
        assert viewer.controls.yaw == yaw
        person.wait(
            "the whole cube", lambda: is_red(person.look(box))[:, half:].any()
        )
        viewer.comparison.choice = None
        viewer.request_redraw()
        person.wait(
            "one picture",
            lambda: bool((person.look(box)[:, :width] == before).all()),
        )

    watch(story)


def test_the_profiler_shows_where_time_goes(watch: Watch) -> None:
    def story(person: Person, viewer: Viewer) -> None:
        for panel in viewer.panels:
            panel.starts_open = panel.title == "Profiler"
        viewer.event(DropEvent(()))
        person.act("mousemove 60 60")
        person.act("mousemove 70 60")
        person.wait("times of the CPU", lambda: bool(viewer.times.cpu.series))

        def has_gpu() -> bool:
            viewer.request_redraw()
            return "scene" in viewer.times.gpu.series

        person.wait("times of the GPU", has_gpu)
        assert viewer.times.gpu.mean("scene", 1) > 0.0
        assert viewer.frame is not None
        assert viewer.frame.wait().gl_draws > 0

    watch(story)


def test_the_copied_command_makes_the_picture_that_is_seen(
    watch: Watch, tmp_path: Path
) -> None:
    saved = tmp_path / "seen.png"

    def story(person: Person, viewer: Viewer) -> None:
        # Away from the centre, through another lens, and encoded otherwise.
        viewer.controls.orbit(0.2, 0.1)
        viewer.controls.pan(0.05, 0.1, viewer.camera)
        viewer.controls.apply(viewer.camera)
        viewer.camera.projection = Perspective(math.radians(30), near=0.004)
        viewer.scene.background_blur = 0.3
        viewer.choices.change_settings(gamma=1.8, exposure=-1.0, brdf="karis")
        drawn = {viewer.frame}

        def is_drawn() -> bool:
            drawn.add(viewer.frame)
            viewer.request_redraw()
            return len(drawn) > 3

        person.wait("frames of it", is_drawn)
        viewer.save_picture(saved)
        person.wait("a file", lambda: viewer.message == f"saved {saved}")
        person.act("mousemove 60 60 key ctrl+c")
        person.wait("a copy", lambda: "copied" in (viewer.message or ""))
        assert viewer.window is not None
        (tmp_path / "command").write_text(picture_command(viewer))

    watch(story)
    words = shlex.split((tmp_path / "command").read_text())
    assert words[:2] == ["moka", "render"]
    again = tmp_path / "again.png"
    words[-1] = str(again)
    assert main([*words[1:], "--backend", "egl"]) == 0
    with PillowImage.open(saved) as seen, PillowImage.open(again) as made:
        assert seen.size == made.size
        difference = np.asarray(seen, int) - np.asarray(made, int)
    assert is_red(np.asarray(PillowImage.open(saved).convert("RGB"))).any()
    # Camera matrices that differ in their last digits.
    assert (np.abs(difference).max(axis=2) > 1).mean() < 1e-3


def test_what_was_chosen_is_remembered(
    display: str,  # noqa: ARG001
    model: Path,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.setenv("MOKA_CONFIG_DIR", str(tmp_path / "config"))
    environment = tmp_path / "bright.hdr"
    write_radiance_hdr(environment, np.full((4, 8, 3), 2.0, np.float32))
    words = ["view", str(model), "--exposure", "-1", "--size", "400x300"]
    seen: list[Viewer] = []

    def draw(viewer: Viewer, *given: Any) -> None:
        seen.append(viewer)
        original(viewer, *given)
        if viewer.environment_source != str(environment):
            viewer.open_environment(str(environment))
        elif viewer.model is not None and not viewer.work.doing:
            viewer.choices.change_settings(tone_map="agx")
            viewer.quit()
        viewer.request_redraw()

    original = Viewer.draw
    monkeypatch.setattr(Viewer, "draw", draw)
    assert main(words) == 0
    first = seen[-1]
    seen.clear()
    assert main(["view", "--exposure", "0.5"]) == 0
    again = seen[0]
    assert again.begun.environment == str(environment)
    assert again.settings.tone_map == "agx"
    assert again.begun.settings.exposure == 0.5
    assert again.begun.size == first.begun.size == SIZE
    assert str(model) in again.preferences.recent_models
    environment.unlink()
    monkeypatch.setattr(Viewer, "draw", lambda viewer, *_: see(viewer))

    def see(viewer: Viewer) -> None:
        seen.append(viewer)
        viewer.quit()

    assert main(["view"]) == 0
    assert seen[-1].begun.environment == "studio"
    assert seen[-1].settings.tone_map == "agx"
    assert main(["view", "--no-preferences", "--size", "64x64"]) == 0
    assert seen[-1].settings.tone_map == "neutral"


def test_the_window_answers_while_images_are_decoded(
    watch: Watch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what cannot be decoded is told, and changes nothing."""
    slow, broken = tmp_path / "slow.glb", tmp_path / "broken.glb"
    encoded = io.BytesIO()
    PillowImage.new("RGB", (4, 4), (10, 200, 30)).save(encoded, "PNG")
    for path, data in (
        (slow, encoded.getvalue()),
        (broken, encoded.getvalue()[:40]),
    ):
        image = EncodedImage("picture", data=data)
        material = Material(
            base_colour_texture=Texture(image), metallic_factor=0.0
        )
        save_model(model_of([(cube(1.0), material, np.eye(4))]), path)
    begun, go_on = threading.Event(), threading.Event()

    def decode_slowly(image: EncodedImage) -> Any:
        begun.set()
        assert go_on.wait(30)
        return decode_image(image)

    monkeypatch.setattr("moka.core.decode.decode_image", decode_slowly)

    def story(person: Person, viewer: Viewer) -> None:
        before = viewer.model
        viewer.open_model(slow)
        person.wait("decoding", begun.is_set)
        assert viewer.model is before
        # Told by another thread than the one that decodes.
        told = "decoding images of slow.glb: 0 of 1"
        person.wait("progress", lambda: viewer.work.doing == told)
        frame, distance = viewer.frame, viewer.controls.distance
        person.act("mousemove 80 150 click 4")
        person.wait("a zoom", lambda: viewer.controls.distance < distance)
        person.wait("a frame", lambda: viewer.frame is not frame)
        assert viewer.model is before
        go_on.set()
        person.wait("the model", lambda: viewer.model is not before)
        shown = viewer.model
        viewer.open_model(broken)
        person.wait("an error", lambda: viewer.error is not None)
        assert viewer.model is shown

    watch(story)


def test_what_is_opened_is_prepared_elsewhere(
    watch: Watch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    threads: dict[str, set[str]] = {"light": set(), "vertices": set()}

    def noting(what: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def note(*values: Any, **named: Any) -> Any:
            threads[what].add(threading.current_thread().name)
            return function(*values, **named)

        return note

    monkeypatch.setattr(
        LightingMaker, "make", noting("light", LightingMaker.make)
    )
    monkeypatch.setattr(
        geometry, "vertices_of", noting("vertices", geometry.vertices_of)
    )
    lit = tmp_path / "lit.hdr"
    write_radiance_hdr(lit, np.full((16, 32, 3), 0.5, np.float32))
    ball = tmp_path / "ball.glb"
    save_model(model_of([(sphere(), Material(), np.eye(4))]), ball)

    def story(person: Person, viewer: Viewer) -> None:
        environment, model = viewer.scene.environment, viewer.model
        viewer.open(lit)
        person.wait(
            "the light", lambda: viewer.scene.environment is not environment
        )
        viewer.open(ball)
        person.wait("the model", lambda: viewer.model is not model)
        viewer.choices.compare_with("filtered lighting")
        person.wait(
            "another picture",
            lambda: viewer.comparison.choice == "filtered lighting",
        )
        viewer.choices.change_settings(ibl="reference")
        person.wait("another mode", lambda: viewer.settings.ibl == "reference")
        box = (20, 20, 60, 60)
        person.wait("a picture", lambda: bool(person.look(box).any()))

    viewer = watch(story)
    assert viewer.error is None
    for what, names in threads.items():
        assert names, what
        assert all(name.startswith("moka-background") for name in names), what


def test_a_picture_is_saved_whole_where_another_one_stands_beside_it(
    watch: Watch, tmp_path: Path
) -> None:
    saved = [tmp_path / name for name in ("alone.png", "beside.png")]

    def story(person: Person, viewer: Viewer) -> None:
        for path in saved:
            viewer.save_picture(path)
            person.wait("a file", lambda path=path: path.exists())  # type: ignore[misc]
            drawn = {viewer.frame}
            viewer.comparison.choice = "BRDF blinn-phong"

            def is_drawn(drawn: set[Any] = drawn) -> bool:
                drawn.add(viewer.frame)
                viewer.request_redraw()
                return len(drawn) > 3

            person.wait("frames", is_drawn)

    watch(story)
    alone, beside = (np.asarray(PillowImage.open(path)) for path in saved)
    np.testing.assert_array_equal(alone, beside)


def test_what_is_asked_while_a_frame_is_drawn_is_saved_of_the_next(
    watch: Watch, tmp_path: Path
) -> None:
    """As from another thread, in the middle of half a picture."""
    saved = tmp_path / "asked.png"

    def story(person: Person, viewer: Viewer) -> None:
        viewer.comparison.choice = "BRDF blinn-phong"
        viewer.request_redraw()
        person.wait("half", lambda: viewer.renderer.area is not None)
        record = viewer.readbacks.record

        def ask_first(commands: CommandList) -> None:
            viewer.readbacks.record = record  # type: ignore[method-assign]
            viewer.save_picture(saved)
            record(commands)

        viewer.readbacks.record = ask_first  # type: ignore[method-assign]
        viewer.request_redraw()
        person.wait("a file", saved.exists)

    watch(story)
    picture = np.asarray(PillowImage.open(saved))
    # The cube stands in the middle; the other picture shows none of it red.
    found = is_red(picture).any(axis=0)
    left, right = np.array_split(found, 2)
    assert left.sum() > 0.7 * right.sum() > 0.4 * left.sum() > 0


def test_numbers_that_mean_nothing_are_told(watch: Watch) -> None:
    """As somebody types them into a slider."""

    def story(person: Person, viewer: Viewer) -> None:
        before = viewer.settings
        viewer.choices.change_settings(exposure=1000.0)
        assert viewer.error is not None
        assert "exposure" in viewer.error
        assert viewer.settings == before
        person.wait("an answer", lambda: viewer.frame is not None)

    watch(story)


def test_a_path_is_typed_and_opened(watch: Watch, tmp_path: Path) -> None:
    """The panel of the model is on top of the column."""
    other = tmp_path / "other.glb"
    blue = Material(base_colour_factor=(0.05, 0.1, 1, 1), metallic_factor=0.0)
    save_model(model_of([(cube(1.0), blue, np.eye(4))]), other)

    def story(person: Person, viewer: Viewer) -> None:
        person.act("mousemove 250 63")
        person.wait("the panel", lambda: viewer.interface.wants_pointer)
        person.act("click 1")
        person.wait("a field", lambda: viewer.interface.wants_keyboard)
        person.act(f"type --delay 20 {other}")
        person.act("key Return")
        person.wait("it", lambda: viewer.files.model_source == other)
        assert viewer.preferences.recent_models[0] == str(other)

    watch(story)
