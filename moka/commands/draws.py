"""Draws as rows of one structured array, and the instances they name.

A Python object per draw and frame costs more than the draw itself, so that
a thousand draws are recorded, sorted and batched with array operations. The
original's report names this model (plain commands in one contiguous buffer)
as the better one; here it is the model.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["DRAW", "INSTANCE", "Draws", "Instances", "identity_instance"]

# One draw: which resources (slots of handles), which raster state (index
# into the list's states), which rows of the instance array.
DRAW = np.dtype(
    [
        ("key", np.uint64),
        ("program", np.uint32),
        ("bind_group", np.uint32),
        ("mesh", np.uint32),
        ("state", np.uint32),
        ("first_instance", np.uint32),
        ("instance_count", np.uint32),
    ]
)

# One instance as the vertex shader reads it: the upper three rows of the
# affine object-to-world matrix, the row of its material, its object number
# and one spare word. 64 bytes, so a row never straddles a cache line.
INSTANCE = np.dtype(
    [
        ("transform", np.float32, (3, 4)),
        ("material", np.uint32),
        ("object", np.uint32),
        ("spare", np.uint32, (2,)),
    ]
)

Draws = NDArray[np.void]
Instances = NDArray[np.void]


def identity_instance() -> Instances:
    """One instance that stays where its vertices are."""
    instance = np.zeros(1, INSTANCE)
    instance["transform"] = np.eye(3, 4)
    return instance
