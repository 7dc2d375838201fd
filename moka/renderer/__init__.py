"""Turns a scene into passes and packets; knows the frame's order."""

from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings

__all__ = ["RenderSettings", "Renderer"]
