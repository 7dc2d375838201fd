"""The panels of the viewer, in the order of its column."""

from moka.ui.panels.camera import CameraPanel
from moka.ui.panels.comparison import ComparisonPanel
from moka.ui.panels.environment import EnvironmentPanel, LightingPanel
from moka.ui.panels.inspector import InspectorPanel
from moka.ui.panels.lights import LightsPanel
from moka.ui.panels.model import ModelPanel
from moka.ui.panels.output import OutputPanel
from moka.ui.panels.panel import Panel
from moka.ui.panels.picture import PicturePanel
from moka.ui.panels.profiler import ProfilerPanel
from moka.ui.panels.scene_tree import SceneTreePanel
from moka.ui.panels.view import ViewPanel

__all__ = ["all_panels"]


def all_panels() -> list[Panel]:
    """New ones, for a viewer."""
    return [
        ModelPanel(),
        CameraPanel(),
        PicturePanel(),
        EnvironmentPanel(),
        LightsPanel(),
        LightingPanel(),
        ViewPanel(),
        ComparisonPanel(),
        SceneTreePanel(),
        InspectorPanel(),
        ProfilerPanel(),
        OutputPanel(),
    ]
