"""GraphicsDevice, its render thread, programs and shader source."""

from moka.graphics.device import Frame, GraphicsDevice

__all__ = ["Frame", "GraphicsDevice"]
