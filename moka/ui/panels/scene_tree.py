"""The nodes of the model as a tree: what is there, what is shown."""

from typing import TYPE_CHECKING, Any

import numpy as np

from moka.ui.panels.panel import Panel
from moka.ui.tree_rows import TreeRows

if TYPE_CHECKING:
    from moka.model import Model
    from moka.ui.viewer import Viewer

__all__ = ["SceneTreePanel"]

# Rows of text that the tree takes at most: what is selected is below it.
_HEIGHT = 10

# How far deep nodes still move to the right.
_DEEPEST = 10


class SceneTreePanel(Panel):
    """Selects nodes and hides them."""

    title = "Scene"

    def __init__(self) -> None:
        self._model: Model | None = None
        self._rows = TreeRows([], [])
        self._revealed: int | None = None

    def is_useful(self, viewer: "Viewer") -> bool:
        """Whether there are nodes."""
        return viewer.model is not None and len(viewer.model.model.nodes) > 0

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The search, and of the tree what fits."""
        assert viewer.model is not None
        self._follow(viewer.model.model)
        imgui.set_next_item_width(-1)
        _, self._rows.search = imgui.input_text_with_hint(
            "##search", "search", self._rows.search
        )
        line = imgui.get_frame_height_with_spacing()
        is_new = self._reveal(viewer.selection)
        rows = self._rows.seen
        height = min(max(len(rows), 1), _HEIGHT) * line
        if imgui.begin_child("nodes", (0, height)):
            if is_new and viewer.selection in rows:
                place = rows.index(viewer.selection)
                imgui.set_scroll_y(max((place + 0.5) * line - height / 2, 0.0))
            clipper = imgui.ListClipper()
            clipper.begin(len(rows), line)
            while clipper.step():
                for at in range(clipper.display_start, clipper.display_end):
                    self._draw_row(imgui, viewer, rows[at])
        imgui.end_child()
        imgui.text_disabled(f"{len(rows):,} of {len(self._rows):,} nodes")

    def _follow(self, model: "Model") -> None:
        """Know the nodes of the model that is open."""
        if self._model is model:
            return
        self._model = model
        self._revealed = None
        nodes = model.nodes
        names = [
            name or f"node {number}"
            for name, number in zip(
                nodes.names, np.asarray(nodes.source).tolist(), strict=True
            )
        ]
        self._names = names
        self._rows = TreeRows(nodes.parents, names)
        if len(names) <= _HEIGHT:
            for row in range(len(names)):
                self._rows.reveal(row)

    def _reveal(self, selection: int | None) -> bool:
        """Open what is above a node that was selected elsewhere."""
        if selection == self._revealed:
            return False
        self._revealed = selection
        if selection is not None:
            self._rows.reveal(selection)
        return selection is not None

    def _draw_row(self, imgui: Any, viewer: "Viewer", row: int) -> None:
        assert viewer.model is not None
        rows = self._rows
        node = viewer.model.node(row)
        imgui.push_id(row)
        changed, visible = imgui.checkbox("##visible", node.visible)
        if changed:
            node.visible = visible
            viewer.edits.add("nodes shown or hidden")
            viewer.request_redraw()
        depth = 0 if rows.search else min(int(rows.depth[row]), _DEEPEST)
        imgui.same_line(
            imgui.get_cursor_start_pos().x
            + imgui.get_frame_height()
            + 0.6 * imgui.get_font_size() * (depth + 1)
        )
        flags = imgui.TreeNodeFlags_
        wanted = (
            flags.open_on_arrow
            | flags.span_avail_width
            | flags.no_tree_push_on_open
        )
        if rows.search or not rows.has_children(row):
            wanted |= flags.leaf
        if viewer.selection == row:
            wanted |= flags.selected
        imgui.set_next_item_open(rows.is_open(row))
        imgui.tree_node_ex(self._names[row], wanted)
        if imgui.is_item_toggled_open():
            rows.toggle(row)
        elif imgui.is_item_clicked():
            viewer.selection = self._revealed = row
            viewer.request_redraw()
        imgui.pop_id()
