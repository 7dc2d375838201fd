"""What a panel of the viewer is."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moka.ui.viewer import Viewer

__all__ = ["Panel", "tell_of_motion"]


class Panel(ABC):
    """A part of the viewer's column; drawn anew in every frame."""

    title: str
    starts_open = False
    is_open = False

    def is_useful(self, _viewer: "Viewer") -> bool:
        """Whether there is anything to show for what is open."""
        return True

    @abstractmethod
    def draw(self, imgui: Any, viewer: "Viewer") -> None:
        """Say what there is to see, and do what a person wants.

        ``imgui`` is the module; between a header and the next one.
        """

    def close(self) -> None:  # noqa: B027
        """Called once at the end."""


def tell_of_motion(imgui: Any, viewer: "Viewer") -> None:
    """Say why samples of reference lighting do not add up, if so."""
    if viewer.is_animating or viewer.auto_rotates:
        what = "the animation" if viewer.is_animating else "the turning (R)"
        imgui.text_wrapped(f"Pause {what}: samples add up while all stands.")
