"""The tables of the specular lobes' directional albedo.

They depend on nothing but the formulas, so that they are made once, by
:mod:`moka.lighting.make_brdf_tables`, and come along as assets: to draw one
takes as long as to read a thousand.
"""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import PixelFormat, TextureDescriptor
from moka.commands.handles import Handle
from moka.core.errors import MokaError
from moka.core.resources import asset_folder
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment_maps import CUBE_SAMPLER

__all__ = [
    "TABLE",
    "TABLE_SAMPLER",
    "TABLE_SIZE",
    "load_brdf_table",
    "read_brdf_table",
    "table_path",
]

TABLE_SIZE = 128

TABLE = TextureDescriptor(
    PixelFormat.RG32F, TABLE_SIZE, TABLE_SIZE, label="table"
)
TABLE_SAMPLER = CUBE_SAMPLER


def table_path(brdf: str) -> Path:
    """The file of the table of ``gltf``, ``karis`` or ``blinn-phong``."""
    return asset_folder() / f"albedo-{brdf}.u16"


@cache
def read_brdf_table(brdf: str) -> NDArray[np.float32]:
    """The table (128, 128, 2): rows of roughness, columns of n.v.

    From 0 at the first to 1 at the last. The lobe reflects f0 times the
    first value and f90 times the second of uniform light (Karis 2013,
    equation 8). The file has both as parts of 65535, little-endian. Raises
    MokaError if it is missing from the installation or not whole.
    """
    path = table_path(brdf)
    try:
        parts = np.fromfile(path, "<u2")
        table = parts.reshape(TABLE_SIZE, TABLE_SIZE, 2)
    except (OSError, ValueError) as error:
        raise MokaError(
            f"{path}: missing or broken; install moka-pbr again"
        ) from error
    values: NDArray[np.float32] = np.divide(table, 65535, dtype=np.float32)
    return values


def load_brdf_table(device: GraphicsDevice, brdf: str) -> Handle:
    """The table as a texture: x is n.v, y is roughness."""
    return device.create_texture(TABLE, [read_brdf_table(brdf)])
