"""The numbers of a material, as the inspector shows and changes them."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from moka.material.material import AlphaMode, Material, Texture
from moka.material.numbers import can_change
from moka.model import quad
from moka.scene.scene import Scene
from moka.ui.panels.material import changes_of_material, material_numbers
from tests.support.pictures import encoded, scene_of

imgui = pytest.importorskip("imgui_bundle").imgui

GREY = Texture(encoded(np.full((1, 1, 3), 128, np.uint8)))
PLASTIC = Material(metallic_factor=0.0, emissive_factor=(0.5, 1.0, 2.0))
LACQUER = replace(PLASTIC, ior=1.4)


class Hand:
    """Stands for Dear ImGui and for whoever moves the widgets ``to``."""

    ColorEditFlags_ = imgui.ColorEditFlags_
    HoveredFlags_ = imgui.HoveredFlags_
    SliderFlags_ = imgui.SliderFlags_

    def __init__(self, to: dict[str, Any] | None = None) -> None:
        self._to = to or {}
        self.shown: dict[str, Any] = {}
        self.disabled: set[str] = set()
        self.hints: list[str] = []
        self._is_disabled = False

    def slider_float(self, label: str, value: Any, *_: Any) -> Any:
        self.shown[label] = value
        if self._is_disabled:
            self.disabled.add(label)
            return False, value
        return label in self._to, self._to.get(label, value)

    color_edit3 = color_edit4 = slider_float

    def button(self, label: str) -> bool:
        return label in self._to

    def begin_disabled(self, is_disabled: bool) -> None:
        self._is_disabled = is_disabled

    def end_disabled(self) -> None:
        self._is_disabled = False

    def is_item_hovered(self, _: int) -> bool:
        return True

    def begin_tooltip(self) -> bool:
        return True

    def text(self, text: str) -> None:
        self.hints.append(text)

    def get_font_size(self) -> float:
        return 13.0

    def push_text_wrap_pos(self, width: float) -> None:
        """Nothing is laid out here, and so for what comes after it."""

    def pop_text_wrap_pos(self) -> None: ...

    def end_tooltip(self) -> None: ...


def shown_of(
    material: Material, to: dict[str, Any] | None = None
) -> tuple[Hand, Scene]:
    """The widgets of a scene's only material, after a change of it."""
    scene = scene_of([(quad(), material, np.eye(4))])
    hand = Hand(to)
    changes = changes_of_material(hand, scene, material)
    if changes:
        scene.edit_material(material, **changes)
    again = Hand()
    assert not changes_of_material(again, scene, material)
    return again, scene


@pytest.mark.parametrize(
    ("material", "numbers"),
    [
        (PLASTIC, {"roughness", "metalness", "emission", "strength"}),
        (replace(PLASTIC, unlit=True), set()),
        (
            replace(PLASTIC, unlit=True, alpha_mode=AlphaMode.MASK),
            {"alpha cutoff"},
        ),
        (
            replace(PLASTIC, normal_texture=GREY, occlusion_texture=GREY),
            {
                *("roughness", "metalness", "emission", "strength"),
                *("normal scale", "occlusion"),
            },
        ),
        (
            LACQUER,
            {
                *("roughness", "metalness", "emission", "strength"),
                *("refractive index", "specular", "specular colour"),
            },
        ),
    ],
)
def test_there_is_a_widget_for_what_changes_the_picture(
    material: Material, numbers: set[str]
) -> None:
    hand, _ = shown_of(material)
    assert hand.shown.keys() == {"base colour", *numbers}
    for field in material_numbers(material):
        assert can_change(material, field)


@pytest.mark.parametrize(
    ("to", "field", "value"),
    [
        ({"roughness": 0.25}, "roughness_factor", 0.25),
        ({"metalness": 1.0}, "metallic_factor", 1.0),
        ({"metalness": 7.0}, "metallic_factor", 1.0),
        ({"refractive index": 1.5}, "ior", 1.5),
        ({"refractive index": 0.5}, "ior", 1.0),
        ({"specular": 0.0}, "specular_factor", 0.0),
        ({"specular colour": [2, 0, -1]}, "specular_colour_factor", (2, 0, 0)),
        ({"base colour": [1, 2, 0]}, "base_colour_factor", (1, 1, 0, 1)),
        ({"emission": [1, 0, 0]}, "emissive_factor", (2, 0, 0)),
        ({"strength": 4.0}, "emissive_factor", (1, 2, 4)),
    ],
)
def test_a_widget_changes_its_number(
    to: dict[str, Any], field: str, value: Any
) -> None:
    _, scene = shown_of(LACQUER, to)
    assert getattr(scene.material_now(LACQUER), field) == value


def test_emission_that_was_put_out_can_be_lit_again() -> None:
    scene = scene_of([(quad(), PLASTIC, np.eye(4))])
    for strength, expected in ((0.0, 0.001), (3.0, 3.0)):
        hand = Hand({"strength": strength})
        scene.edit_material(
            PLASTIC, **changes_of_material(hand, scene, PLASTIC)
        )
        now = scene.material_now(PLASTIC)
        assert max(now.emissive_factor) == pytest.approx(expected)
        # Whatever the strength, the colour is kept.
        assert np.array(now.emissive_factor) / max(
            now.emissive_factor
        ) == pytest.approx([0.25, 0.5, 1.0])


def test_what_the_shader_cannot_draw_says_why() -> None:
    metal = Material()
    hand, scene = shown_of(metal, {"metalness": 0.5, "strength": 3.0})
    assert hand.disabled == {"metalness", "emission", "strength"}
    assert "pure metal" in hand.hints[0]
    assert "dark" in hand.hints[1]
    assert scene.material_now(metal) is metal


@pytest.mark.parametrize("ior", [0.0, 1.4])
def test_a_material_is_again_as_it_was_loaded(ior: float) -> None:
    material = replace(LACQUER, ior=ior)
    scene = scene_of([(quad(), material, np.eye(4))])
    scene.edit_material(material, ior=2.0, roughness_factor=0.1)
    hand = Hand({"as loaded": True})
    scene.edit_material(material, **changes_of_material(hand, scene, material))
    now = scene.material_now(material)
    assert (now.ior, now.roughness_factor) == (ior, 1.0)
