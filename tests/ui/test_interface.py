"""Panels drawn through the command list into a picture."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.app.events import (
    KeyEvent,
    MouseButtonEvent,
    MouseMoveEvent,
    TextEvent,
)
from moka.app.keys import Key, Modifiers, MouseButton
from moka.commands.command_list import CommandList
from moka.commands.descriptors import (
    Attachment,
    FramebufferDescriptor,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.ui.interface import Interface, _keys

pytest.importorskip("imgui_bundle")
pytestmark = pytest.mark.gpu

SIZE = (120, 80)


@pytest.fixture(scope="module")
def device() -> Iterator[GraphicsDevice]:
    with GraphicsDevice.open("egl", debug=True) as opened:
        yield opened


@pytest.fixture
def interface(device: GraphicsDevice) -> Iterator[Interface]:
    made = Interface(device)
    yield made
    made.close()


def shown(
    device: GraphicsDevice, interface: Interface, pixels: tuple[int, int]
) -> NDArray[np.uint8]:
    """The panels over grey, (H, W, 4), top row first."""
    texture = device.create_texture(
        TextureDescriptor(PixelFormat.RGBA8, *pixels)
    )
    framebuffer = device.create_framebuffer(
        FramebufferDescriptor((Attachment(texture),))
    )
    commands = CommandList()
    setup = commands.command_buffer(SortKey(1))
    setup.bind_framebuffer(framebuffer)
    setup.clear((0.2, 0.2, 0.2, 1.0))
    interface.draw(commands, SortKey(2), framebuffer, pixels)
    read = commands.read_pixels(
        framebuffer, (0, 0, *pixels), dtype="u1", key=SortKey(3)
    )
    device.submit(commands).wait()
    device.destroy(framebuffer, texture)
    assert read.data is not None
    found: NDArray[np.uint8] = read.data[::-1]
    return found


@pytest.mark.parametrize("enlarged", [1, 2])
def test_a_rectangle_is_where_it_is_put(
    device: GraphicsDevice, interface: Interface, enlarged: int
) -> None:
    """Also on a display whose pixels are smaller than its coordinates."""
    with interface.frame(SIZE, 0.1) as imgui:
        drawn = imgui.get_foreground_draw_list()
        drawn.push_clip_rect((0, 0), (100, 30))
        drawn.add_rect_filled((20, 10), (60, 50), 0xFF0000FF)
        drawn.pop_clip_rect()
    pixels = shown(device, interface, (SIZE[0] * enlarged, SIZE[1] * enlarged))
    is_red = (pixels == (255, 0, 0, 255)).all(axis=2)
    expected = np.zeros_like(is_red)
    expected[10 * enlarged : 30 * enlarged, 20 * enlarged : 60 * enlarged] = 1
    assert (is_red == expected).all()
    assert (pixels[~expected] == (51, 51, 51, 255)).all()


def test_half_a_colour_is_blended(
    device: GraphicsDevice, interface: Interface
) -> None:
    with interface.frame(SIZE, 0.1) as imgui:
        drawn = imgui.get_foreground_draw_list()
        drawn.add_rect_filled((0, 0), SIZE, 0x80FFFFFF)
    pixels = shown(device, interface, SIZE)
    expected = 51 + (255 - 51) * 128 / 255
    assert np.abs(pixels[..., :3] - expected).max() <= 1


def test_text_is_drawn_and_new_letters_enlarge_the_texture(
    device: GraphicsDevice, interface: Interface
) -> None:
    for text in ("moka", "".join(map(chr, range(33, 127))) * 2):
        with interface.frame(SIZE, 0.1) as imgui:
            drawn = imgui.get_foreground_draw_list()
            drawn.add_text((4, 4), 0xFFFFFFFF, text)
            drawn.add_text(imgui.get_font(), 40.0, (4, 30), 0xFFFFFFFF, text)
        pixels = shown(device, interface, SIZE)
        assert (pixels[..., 0] > 200).sum() > 20


def test_a_click_presses_the_button_under_it(
    device: GraphicsDevice,  # noqa: ARG001
    interface: Interface,
) -> None:
    presses = 0
    for events in (
        [MouseMoveEvent(30, 40, 0, 0)],
        [],
        [MouseButtonEvent(MouseButton.LEFT, True, 30, 40, Modifiers.NONE)],
        [MouseButtonEvent(MouseButton.LEFT, False, 30, 40, Modifiers.NONE)],
        [],
    ):
        for event in events:
            interface.take(event)
        with interface.frame(SIZE, 0.1) as imgui:
            imgui.set_next_window_pos((0, 0))
            imgui.set_next_window_size(SIZE)
            imgui.begin("panel")
            presses += imgui.button("press", (100, 40))
            imgui.end()
    assert presses == 1
    assert interface.wants_pointer
    assert not interface.wants_keyboard


def test_typed_text_reaches_a_field(
    device: GraphicsDevice,  # noqa: ARG001
    interface: Interface,
) -> None:
    text = ""
    for number, events in enumerate(
        (
            [],
            [],
            [TextEvent("ab"), TextEvent("é")],
            [KeyEvent(Key.BACKSPACE, True, False, Modifiers.NONE)],
            [],
        )
    ):
        for event in events:
            interface.take(event)
        with interface.frame(SIZE, 0.1) as imgui:
            imgui.begin("panel")
            if number == 0:
                imgui.set_keyboard_focus_here()
            _, text = imgui.input_text("name", text)
            imgui.end()
    assert text == "ab"
    assert interface.wants_keyboard


def test_a_frame_that_fails_leaves_the_next_one_whole(
    device: GraphicsDevice,  # noqa: ARG001
    interface: Interface,
) -> None:
    with pytest.raises(ValueError, match="panel"), interface.frame(SIZE, 0.1):
        raise ValueError("panel")
    with interface.frame(SIZE, 0.1) as imgui:
        imgui.begin("panel")
        imgui.end()


def test_keys_that_panels_know_are_known() -> None:
    missing = {key.name for key in Key} - {key.name for key in _keys()}
    # Dear ImGui has no more function keys, and no keys without a name.
    assert missing == {"UNKNOWN", "F25", "WORLD_1", "WORLD_2"}
