"""GraphicsDevice, its render thread, programs and shader source."""
