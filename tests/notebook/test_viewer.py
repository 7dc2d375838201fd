"""The viewer of notebooks, driven by the events of its page, without one."""

import asyncio
import importlib
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("jupyter_rfb", reason="jupyter_rfb is not installed")

import moka
from moka.core.errors import DeviceError, ModelError, OptionError
from moka.notebook import Viewer
from tests.support.animated import AnimatedFile

pytestmark = pytest.mark.gpu

SIZE = (64, 36)


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    viewer = Viewer(size=SIZE)
    yield viewer
    viewer.close()


def send(viewer: Viewer, kind: str, **values: Any) -> None:
    """What the page would send."""
    event = {"type": kind, "timestamp": 0.0, **values}
    if kind.startswith("pointer") or kind == "wheel":
        event = {"buttons": [], "modifiers": [], "x": 0, "y": 0, **event}
    viewer._rfb_handle_msg(viewer, event, [])


def drag(viewer: Viewer, button: int, by: tuple[int, int], **more: Any) -> None:
    send(viewer, "pointer_down", x=30, y=20, button=button, buttons=[button])
    x, y = 30 + by[0], 20 + by[1]
    send(viewer, "pointer_move", x=x, y=y, buttons=[button], **more)
    send(viewer, "pointer_up", x=x, y=y, button=button)


def test_a_frame_is_the_picture_of_the_command_line(viewer: Viewer) -> None:
    frame = viewer.get_frame()
    assert frame.shape == (36, 64, 4)
    assert frame.dtype == np.uint8
    expected = moka.render(size=SIZE).to_display()
    # Half floats on the way, in place of float32.
    assert np.abs(frame.astype(int) - expected).max() <= 1


def test_dragging_orbits_as_far_as_in_a_window(viewer: Viewer) -> None:
    before, target = viewer.get_frame(), viewer.controls.target
    yaw, pitch = viewer.controls.yaw, viewer.controls.pitch
    drag(viewer, 1, (9, 3))
    assert viewer.controls.yaw == pytest.approx(yaw - np.pi * 9 / 36)
    assert viewer.controls.pitch == pytest.approx(pitch + np.pi * 3 / 36)
    np.testing.assert_array_equal(viewer.controls.target, target)
    assert np.abs(viewer.get_frame().astype(int) - before).max() > 30


@pytest.mark.parametrize(
    ("button", "more"), [(2, {}), (3, {}), (1, {"modifiers": ["Shift"]})]
)
def test_dragging_otherwise_moves(
    viewer: Viewer, button: int, more: dict[str, Any]
) -> None:
    yaw, target = viewer.controls.yaw, viewer.controls.target
    drag(viewer, button, (9, 0), **more)
    assert viewer.controls.yaw == yaw
    assert np.linalg.norm(viewer.controls.target - target) > 0.1


def test_moving_without_a_button_does_nothing(viewer: Viewer) -> None:
    world = viewer.camera.transform.world_matrix.copy()
    send(viewer, "pointer_move", x=60, y=30)
    np.testing.assert_array_equal(viewer.camera.transform.world_matrix, world)


def test_the_wheel_comes_nearer_to_what_is_under_the_pointer(
    viewer: Viewer,
) -> None:
    distance, target = viewer.controls.distance, viewer.controls.target
    send(viewer, "wheel", x=32, y=18, dx=0, dy=-100)
    assert viewer.controls.distance == pytest.approx(0.88 * distance)
    np.testing.assert_allclose(viewer.controls.target, target, atol=1e-12)
    send(viewer, "wheel", x=64, y=18, dx=0, dy=-100)
    right = viewer.camera.transform.world_matrix[:3, 0]
    assert (viewer.controls.target - target) @ right > 0


def test_a_double_click_shows_everything_again(viewer: Viewer) -> None:
    send(viewer, "double_click", x=1, y=1, button=1, buttons=[1])
    before = viewer.get_frame()
    drag(viewer, 2, (20, 20))
    send(viewer, "wheel", x=0, y=0, dx=0, dy=-500)
    assert np.abs(viewer.get_frame().astype(int) - before).max() > 30
    send(viewer, "double_click", x=1, y=1, button=1, buttons=[1])
    assert np.abs(viewer.get_frame().astype(int) - before).max() <= 1


def test_the_picture_has_the_pixels_of_the_page(viewer: Viewer) -> None:
    send(viewer, "resize", width=40, height=30, ratio=1.5)
    assert viewer.get_frame().shape == (45, 60, 4)
    # Hidden by the page: nothing to draw, and nothing goes wrong.
    send(viewer, "resize", width=0, height=0, ratio=1.5)
    assert viewer.get_frame().shape == (45, 60, 4)
    assert viewer.image().size == (60, 45)


def test_frames_are_drawn_on_demand(viewer: Viewer) -> None:
    sent: list[Any] = []
    viewer.send = lambda message, _buffers=None: sent.append(message)

    async def page() -> None:
        viewer._has_visible_views = True
        send(viewer, "resize", width=64, height=36, ratio=1)
        await asyncio.sleep(0.05)
        assert [each["index"] for each in sent] == [1]
        await asyncio.sleep(0.05)
        assert len(sent) == 1
        drag(viewer, 1, (9, 3))
        await asyncio.sleep(0.05)
        assert [each["index"] for each in sent] == [1, 2]

    asyncio.run(page())
    assert {each["mimetype"] for each in sent} == {"image/jpeg"}


def test_reference_lighting_asks_for_more_frames_until_it_is_complete() -> None:
    viewer = Viewer(size=(16, 9), ibl="reference", reference_samples=8)
    frames = 0
    while not viewer.renderer.is_complete or not frames:
        viewer._rfb_draw_requested = False
        viewer.get_frame()
        frames += 1
        assert viewer._rfb_draw_requested is not viewer.renderer.is_complete
        assert frames < 50
    viewer.close()


def test_what_is_changed_is_shown(viewer: Viewer) -> None:
    before = viewer.get_frame().astype(int)
    viewer.scene.environment = None
    assert viewer.get_frame()[..., :3].mean() < 0.2 * before[..., :3].mean()
    viewer.scene.background = "transparent"
    # White is what a page has behind it.
    assert (viewer.get_frame()[0, 0] == 255).all()


def test_an_animation_goes_on_with_the_time_of_the_page() -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), [0, 10], [(0, 0, 0), (9, 0, 0)])
    viewer = Viewer(file.glb(), size=(32, 18))
    viewer.get_frame()
    assert not viewer._rfb_draw_requested
    viewer.model.animations.play(0)
    viewer.get_frame()
    assert viewer._rfb_draw_requested
    time = viewer.model.animations.current.time
    viewer.get_frame()
    assert viewer.model.animations.current.time > time
    viewer.close()


def test_closing_ends_the_render_thread(viewer: Viewer) -> None:
    assert not viewer.is_closed
    viewer.get_frame()
    viewer.close()
    assert viewer.is_closed
    viewer.close()
    send(viewer, "wheel", x=0, y=0, dx=0, dy=100)
    with pytest.raises(DeviceError, match="closed"):
        viewer.get_frame()


def test_without_jupyter_one_line_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import moka.notebook.viewer as module

    monkeypatch.setitem(sys.modules, "jupyter_rfb", None)
    monkeypatch.delitem(sys.modules, module.__name__)
    with pytest.raises(
        OptionError, match=r"pip install 'moka-pbr\[notebook\]'"
    ):
        importlib.import_module(module.__name__)


def test_errors_are_those_of_render() -> None:
    with pytest.raises(ModelError, match=r"nowhere\.glb"):
        Viewer("nowhere.glb")
    with pytest.raises(OptionError, match="tone map"):
        Viewer(tone_map="sepia")
