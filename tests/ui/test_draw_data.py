"""What Dear ImGui wants drawn, as arrays."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from moka.ui.draw_data import VERTEX, flatten

imgui = pytest.importorskip("imgui_bundle").imgui


@pytest.fixture(autouse=True)
def context() -> Iterator[None]:
    made = imgui.create_context()
    imgui.set_current_context(made)
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = imgui.ImVec2(200, 100)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    io.backend_flags |= imgui.BackendFlags_.renderer_has_vtx_offset
    yield
    imgui.destroy_context(made)


def draw(*rectangles: tuple[float, float, float, float]) -> Any:
    """Rectangles over everything, each inside a clip rectangle of its own."""
    imgui.new_frame()
    drawn = imgui.get_foreground_draw_list()
    for left, top, right, bottom in rectangles:
        drawn.push_clip_rect((left, top), (right, bottom))
        drawn.add_rect_filled((0, 0), (200, 100), 0xFF8040C0)
        drawn.pop_clip_rect()
    imgui.render()
    data = imgui.get_draw_data()
    for texture in data.textures:
        texture.set_tex_id(5)
        texture.set_status(imgui.ImTextureStatus.ok)
    return data


def test_nothing_is_an_empty_geometry() -> None:
    geometry = flatten(draw())
    assert geometry.batches == ()
    assert len(geometry.indices) == 0


def test_clip_rectangles_are_in_the_vertices_of_one_batch() -> None:
    first, second = (10, 20, 50, 60), (60, 5, 90, 95)
    geometry = flatten(draw(first, second))
    (batch,) = geometry.batches
    assert (batch.texture, batch.first) == (5, 0)
    assert batch.count == len(geometry.indices) == 12
    corners = geometry.vertices[geometry.indices]
    assert corners.dtype == VERTEX
    assert (corners["clip"][:6] == first).all()
    assert (corners["clip"][6:] == second).all()
    assert (corners["colour"] == (0xC0, 0x40, 0x80, 0xFF)).all()
    for six in (corners[:6], corners[6:]):
        assert np.ptp(six["position"][:, 0]) == 200
        assert np.ptp(six["position"][:, 1]) == 100
