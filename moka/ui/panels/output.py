"""Takes the picture elsewhere: into a file, or as a command."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from moka.ui.panels.panel import Panel
from moka.ui.picture_command import (
    beyond_command,
    copy_command,
    picture_command,
)
from moka.ui.widgets import hint

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["OutputPanel", "unused_path"]


class OutputPanel(Panel):
    """Saves the picture under a name, and copies the command that makes it."""

    title = "Save"

    def __init__(self) -> None:
        self._path = "moka.png"

    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """The widgets."""
        _, self._path = imgui.input_text("file", self._path)
        path = Path(self._path).expanduser()
        for label, suffix in (("save PNG", ".png"), ("save EXR", ".exr")):
            if imgui.button(label) and path.name:
                viewer.save_picture(path.with_suffix(suffix))
            imgui.same_line()
        imgui.new_line()
        if path.name and path.with_suffix(".png").exists():
            imgui.text_disabled("there is such a .png already")
            imgui.same_line()
            if imgui.small_button("another name"):
                self._path = str(unused_path(path.with_suffix(".png")))
        imgui.separator()
        if imgui.button("copy the command"):
            copy_command(viewer)
        hint(imgui, picture_command(viewer))
        missing = beyond_command(viewer)
        if missing:
            imgui.text_disabled("not part of the command:")
            for each in missing:
                imgui.bullet_text(each)


def unused_path(path: Path) -> Path:
    """The first of name.png, name.1.png, ... that is not there yet."""
    found, number = path, 0
    while found.exists():
        number += 1
        found = path.with_name(f"{path.stem}.{number}{path.suffix}")
    return found
