"""What is selected: its place, its mesh and its materials."""

from collections import defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from moka.core.errors import OptionError
from moka.ui.panels.material import changes_of_material
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
        by_material: dict[Material | None, list[Primitive]] = defaultdict(list)
        for primitive in _primitives(viewer):
            by_material[primitive.material].append(primitive)
        for number, (material, drawn) in enumerate(by_material.items()):
            imgui.push_id(number)
            _draw_material(imgui, viewer, material, drawn)
            imgui.pop_id()

    def _place(self, imgui: Any, viewer: "Viewer") -> None:
        assert viewer.model is not None
        node = viewer.model.node(viewer.selection or 0)
        scale = viewer.controls.distance
        # In metres, and relative to the parent's.
        for name, speed in (("position", 0.002 * scale), ("scale", 0.01)):
            value = [float(each) for each in getattr(node, name)]
            changed, value = imgui.drag_float3(name, value, speed)
            if changed:
                setattr(node, name, tuple(value))
                viewer.edits.add("moved nodes")
                viewer.request_redraw()


def _draw_material(
    imgui: Any,
    viewer: "Viewer",
    material: "Material | None",
    drawn: "list[Primitive]",
) -> None:
    """What is drawn with it, and its numbers."""
    imgui.separator()
    for primitive in drawn:
        imgui.text_disabled(
            f"{primitive.topology.value}, {primitive.vertex_count:,} vertices"
        )
    if material is None:
        imgui.text("the default material")
        return
    imgui.text(material.name or "a material without a name")
    changes = changes_of_material(imgui, viewer.scene, material)
    if not changes:
        return
    try:
        viewer.scene.edit_material(material, **changes)
        viewer.edits.add("edited materials")
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
