"""The physics that shaders are compared with: float64, from the formulas."""
