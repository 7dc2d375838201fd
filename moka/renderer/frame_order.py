"""Numbers of what a frame records: what is less comes first.

Passes from 1 to 6 are a renderer's; what has a higher one lies over its
picture.
"""

__all__ = [
    "LAYER_BACKGROUND",
    "LAYER_BLENDED",
    "LAYER_MASK",
    "LAYER_OPAQUE",
    "PASS_ACCUMULATE",
    "PASS_DEBUG",
    "PASS_DISPLAY",
    "PASS_READ",
    "PASS_SCENE",
    "PASS_VALUES",
]

PASS_SCENE = 1
PASS_ACCUMULATE = 2
PASS_DISPLAY = 3
PASS_VALUES = 4
PASS_DEBUG = 5
PASS_READ = 6

# Within the scene pass.
LAYER_OPAQUE = 0
LAYER_MASK = 1
LAYER_BACKGROUND = 2
LAYER_BLENDED = 3
