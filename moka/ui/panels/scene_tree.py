"""The nodes of the model as a tree: what is there, what is shown."""

from typing import TYPE_CHECKING, Any

import numpy as np

from moka.ui.panels.panel import Panel

if TYPE_CHECKING:
    from moka.model import Model
    from moka.ui.viewer import Viewer

__all__ = ["SceneTreePanel"]

# More children than this are drawn where they are looked at only.
_MANY = 200


class SceneTreePanel(Panel):
    """Selects nodes and hides them."""

    title = "Scene"

    def __init__(self) -> None:
        self._model: Model | None = None
        self._children: list[list[int]] = []
        self._roots: list[int] = []
        self._revealed: int | None = None
        self._open: set[int] = set()

    def is_useful(self, viewer: "Viewer") -> bool:
        """Whether there are nodes."""
        return viewer.model is not None and len(viewer.model.model.nodes) > 0

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The tree, or of it what is open."""
        assert viewer.model is not None
        self._follow(viewer.model.model)
        self._reveal(viewer.selection)
        height = (
            min(len(self._children), 14) * imgui.get_text_line_height() * 1.5
        )
        if imgui.begin_child("nodes", (0, height)):
            self._draw_rows(imgui, viewer, self._roots)
        imgui.end_child()

    def _follow(self, model: "Model") -> None:
        """Know the children of every node of the model that is open."""
        if self._model is model:
            return
        self._model = model
        self._open.clear()
        self._revealed = None
        self._children = [[] for _ in range(len(model.nodes))]
        self._roots = []
        for row, parent in enumerate(model.nodes.parents.tolist()):
            siblings = self._roots if parent < 0 else self._children[parent]
            siblings.append(row)

    def _reveal(self, selection: int | None) -> None:
        """Open what is above a node that was selected elsewhere."""
        if selection == self._revealed or self._model is None:
            return
        self._revealed = selection
        row = selection
        while row is not None:
            parent = int(self._model.nodes.parents[row])
            row = parent if parent >= 0 else None
            if row is not None:
                self._open.add(row)

    def _draw_rows(self, imgui: Any, viewer: "Viewer", rows: list[int]) -> None:
        if len(rows) <= _MANY or any(self._children[row] for row in rows):
            for row in rows:
                self._draw_row(imgui, viewer, row)
            return
        clipper = imgui.ListClipper()
        clipper.begin(len(rows))
        while clipper.step():
            for at in range(clipper.display_start, clipper.display_end):
                self._draw_row(imgui, viewer, rows[at])

    def _draw_row(self, imgui: Any, viewer: "Viewer", row: int) -> None:
        assert self._model is not None
        assert viewer.model is not None
        children = self._children[row]
        node = viewer.model.node(row)
        imgui.push_id(row)
        changed, visible = imgui.checkbox("##visible", node.visible)
        if changed:
            node.visible = visible
            viewer.request_redraw()
        imgui.same_line()
        flags = imgui.TreeNodeFlags_
        wanted = flags.open_on_arrow | flags.span_avail_width
        if not children:
            wanted |= flags.leaf
        if viewer.selection == row:
            wanted |= flags.selected
        imgui.set_next_item_open(row in self._open)
        name = self._model.nodes.names[row] or f"node {self._number(row)}"
        is_open = imgui.tree_node_ex(name, wanted)
        if imgui.is_item_toggled_open():
            self._open ^= {row}
        elif imgui.is_item_clicked():
            viewer.selection = self._revealed = row
        if is_open:
            self._draw_rows(imgui, viewer, children)
            imgui.tree_pop()
        imgui.pop_id()

    def _number(self, row: int) -> int:
        assert self._model is not None
        return int(np.asarray(self._model.nodes.source)[row])
