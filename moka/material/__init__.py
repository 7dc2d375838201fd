"""Materials, what shaders must know of them, and what the GPU reads."""
