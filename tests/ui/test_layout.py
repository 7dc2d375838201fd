"""What is told over the picture, and how it looks."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.graphics.device import GraphicsDevice
from moka.ui.interface import Interface
from moka.ui.layout import _draw_state
from moka.ui.style import apply_style
from tests.ui.test_interface import shown

pytest.importorskip("imgui_bundle")
pytestmark = pytest.mark.gpu

SIZE = (400, 240)
LONG = "model.glb: " + "what a driver has to say of a shader, " * 6


@pytest.fixture
def device() -> Iterator[GraphicsDevice]:
    with GraphicsDevice.open("egl", debug=True) as opened:
        yield opened


def told(
    device: GraphicsDevice, interface: Interface, bottom: float, **state: Any
) -> NDArray[np.uint8]:
    """A frame with what is told, (H, W, 4)."""
    viewer: Any = SimpleNamespace(
        area=SIZE,
        work=SimpleNamespace(doing=state.get("doing")),
        message=state.get("message"),
        error=state.get("error"),
    )
    with interface.frame(SIZE, 0.1) as imgui:
        _draw_state(viewer, imgui, bottom)
    return shown(device, interface, SIZE)


def is_red(pixels: NDArray[np.uint8]) -> NDArray[np.bool_]:
    red, green, blue = (pixels[..., i].astype(int) for i in range(3))
    found: NDArray[np.bool_] = (red > 180) & (green < 150) & (blue < 130)
    return found


@pytest.mark.parametrize(
    "state",
    [
        {"error": "no such file"},
        {"error": LONG},
        {"message": "saved moka.png", "error": LONG},
        {"doing": "decoding images of a.glb: 3 of 4"},
    ],
)
def test_the_first_frame_tells_all(
    device: GraphicsDevice, state: dict[str, str]
) -> None:
    """There may be no second one."""
    interface = Interface(device)
    first = told(device, interface, 200.0, **state)
    for _ in range(3):
        last = told(device, interface, 200.0, **state)
    np.testing.assert_array_equal(first, last)
    # The shape of the window, above what is drawn along the lower edge.
    rows, columns = np.nonzero((first != (51, 51, 51, 255)).any(axis=2))
    assert rows.max() < 200 - 8
    assert columns.min() == 8
    if "error" in state:
        text = np.nonzero(is_red(first))
        # Within the window, with a padding on all sides.
        assert rows.min() + 8 <= text[0].min()
        assert text[1].max() <= columns.max() - 8
        assert len(text[0]) > len(state["error"])
    interface.close()


def test_nothing_is_told_of_nothing(device: GraphicsDevice) -> None:
    interface = Interface(device)
    assert (told(device, interface, 200.0) == (51, 51, 51, 255)).all()
    interface.close()


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_sizes_grow_with_the_display(
    device: GraphicsDevice, scale: float
) -> None:
    interface = Interface(device, scale)
    with interface.frame(SIZE, 0.1) as imgui:
        height = imgui.get_text_line_height()
        style = imgui.get_style()
        # Of a font with proportions; all letters of the one that is built
        # in are as wide.
        widths = [imgui.calc_text_size(letter).x for letter in "iW°"]
        assert style.color_(imgui.Col_.window_bg).w == 1.0
    assert height == pytest.approx(15.0 * scale)
    assert style.window_padding.x == 8 * scale
    assert widths[0] < 0.5 * widths[1]
    assert widths[2] > 0.0
    interface.close()


def test_without_the_font_the_style_is_the_same(
    device: GraphicsDevice, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    from moka.ui import style

    monkeypatch.setattr(style, "files", lambda _: tmp_path)
    interface = Interface(device)
    with interface.frame(SIZE, 0.1) as imgui:
        assert imgui.get_text_line_height() == 15.0
        apply_style(imgui, 1.0)
    interface.close()
