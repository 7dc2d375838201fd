"""What is selected: its place, its mesh and its materials."""

from typing import TYPE_CHECKING, Any

import numpy as np

from moka.core.errors import OptionError
from moka.ui.panels.panel import Panel

if TYPE_CHECKING:
    from moka.material.material import Material
    from moka.model.mesh import Primitive
    from moka.ui.viewer import Viewer

__all__ = ["InspectorPanel"]


class InspectorPanel(Panel):
    """Moves the node that is selected, and changes its materials' numbers."""

    title = "Selection"
    starts_open = True

    def is_useful(self, viewer: "Viewer") -> bool:
        """Whether anything is selected."""
        return viewer.model is not None and viewer.selection is not None

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        assert viewer.model is not None
        assert viewer.selection is not None
        nodes = viewer.model.model.nodes
        imgui.text(nodes.names[viewer.selection] or "without a name")
        self._place(imgui, viewer)
        for number, primitive in enumerate(_primitives(viewer)):
            imgui.push_id(number)
            self._primitive(imgui, viewer, primitive)
            imgui.pop_id()

    def _place(self, imgui: Any, viewer: "Viewer") -> None:
        assert viewer.model is not None
        node = viewer.model.node(viewer.selection or 0)
        scale = viewer.controls.distance
        for name, speed in (("position", 0.002 * scale), ("scale", 0.01)):
            value = [float(each) for each in getattr(node, name)]
            changed, value = imgui.drag_float3(name, value, speed)
            if changed:
                setattr(node, name, tuple(value))
                viewer.request_redraw()

    def _primitive(
        self, imgui: Any, viewer: "Viewer", primitive: "Primitive"
    ) -> None:
        imgui.separator()
        material = primitive.material
        imgui.text_disabled(
            f"{primitive.topology.value}, {primitive.vertex_count} vertices"
        )
        if material is None:
            imgui.text("the default material")
            return
        imgui.text(material.name or "a material without a name")
        now = viewer.scene.material_now(material)
        changes = _changes(imgui, now)
        if not changes:
            return
        try:
            viewer.scene.edit_material(material, **changes)
        except OptionError as error:
            viewer.error = str(error)
        viewer.request_redraw()


def _primitives(viewer: "Viewer") -> "list[Primitive]":
    """What the selected node draws."""
    assert viewer.model is not None
    drawables = viewer.scene.drawables
    row = viewer.model.rows[viewer.selection or 0]
    chosen = np.unique(drawables.primitive[drawables.row == row])
    return [drawables.primitives[number] for number in chosen.tolist()]


def _changes(imgui: Any, now: "Material") -> dict[str, Any]:
    """The widgets of a material; what a person changes with them."""
    changes: dict[str, Any] = {}
    changed, colour = imgui.color_edit4(
        "base colour",
        list(now.base_colour_factor),
        imgui.ColorEditFlags_.float,
    )
    if changed:
        changes["base_colour_factor"] = tuple(
            min(max(each, 0.0), 1.0) for each in colour
        )
    numbers = [("roughness", "roughness_factor", 1.0)]
    if not now.unlit:
        numbers.append(("metalness", "metallic_factor", 1.0))
    if now.normal_texture is not None:
        numbers.append(("normal scale", "normal_scale", 4.0))
    if now.occlusion_texture is not None:
        numbers.append(("occlusion", "occlusion_strength", 1.0))
    if now.alpha_mode.name == "MASK":
        numbers.append(("cutoff", "alpha_cutoff", 1.0))
    for name, field, most in numbers:
        changed, value = imgui.slider_float(
            name, getattr(now, field), 0.0, most
        )
        if changed:
            changes[field] = min(max(value, 0.0), most)
    if any(now.emissive_factor):
        changed, colour = imgui.color_edit3(
            "emission",
            list(now.emissive_factor),
            imgui.ColorEditFlags_.float | imgui.ColorEditFlags_.hdr,
        )
        if changed:
            changes["emissive_factor"] = tuple(max(e, 0.0) for e in colour)
    return changes
