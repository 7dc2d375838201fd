"""From an equirectangular map to a cube of radiance and its levels."""

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    TextureBinding,
    TextureDescriptor,
    TextureKind,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment_maps import (
    CUBE_FORMAT,
    CUBE_SAMPLER,
    MAP_SAMPLER,
)
from moka.lighting.equirectangular import uv_to_direction
from moka.lighting.preintegration_passes import PreintegrationPasses
from moka.lighting.specular_cube import SMALLEST_SPECULAR

__all__ = [
    "ALL_FACES",
    "cube_size",
    "downsample",
    "faces_that_differ",
    "map_to_cube",
    "uniform_cube",
]

LARGEST_CUBE = 1024

ALL_FACES = range(6)


def cube_size(map_height: int, *, half: bool = False) -> int:
    """Texels along a cube's edge for a map of ``map_height`` rows.

    As many to the right angle as the map has at its equator, or ``half`` as
    many, rounded up to a power of two.
    """
    # At least two levels: a mirror image, and one for all rough surfaces.
    texels = max(map_height / (4 if half else 2), 2 * SMALLEST_SPECULAR)
    return min(LARGEST_CUBE, 1 << math.ceil(math.log2(texels)))


def uniform_cube(
    device: GraphicsDevice, radiance: NDArray[np.float32]
) -> Handle:
    """``radiance`` (3,) from everywhere: one texel a face says it all."""
    texel = np.append(radiance, np.float32(1))
    return device.create_texture(
        TextureDescriptor(CUBE_FORMAT, 1, 1, TextureKind.CUBE),
        [np.tile(texel, (6, 1, 1, 1))],
    )


def map_to_cube(
    passes: PreintegrationPasses,
    map_texture: Handle,
    map_height: int,
    cube: Handle,
    size: int,
    fine: Collection[int],
) -> None:
    """Resample a map of ``map_height`` rows into level 0 of ``cube``.

    A texel of the faces ``fine`` is the mean of four samples, those of the
    others are one bilinear sample, which for what is even is as good. All
    are of more, if a texel covers several texels of a large map.
    """
    least = -(-map_height // (2 * size))
    passes.cube_level(
        "equirectangular_to_cube.frag",
        cube,
        0,
        size,
        TextureBinding("environment_map", map_texture, MAP_SAMPLER),
        subdivisions=[
            max(2 if face in fine else 1, least) for face in ALL_FACES
        ],
    )


def faces_that_differ(
    one: NDArray[np.float32], other: NDArray[np.float32]
) -> frozenset[int]:
    """The faces of a cube on which two maps (H, W, 3) are not the same.

    With the neighbours of each texel, which bilinear sampling reads.
    """
    height, width, _ = one.shape
    rows, columns = np.nonzero((one != other).any(axis=2))
    faces: set[int] = set()
    for down in (-1.0, 0.0, 1.0):
        for right in (-1.0, 0.0, 1.0):
            place = np.column_stack(
                [
                    (columns + 0.5 + right) / width,
                    np.clip((rows + 0.5 + down) / height, 0.0, 1.0),
                ]
            )
            direction = uv_to_direction(place)
            axis = np.abs(direction).argmax(axis=1)
            side = np.take_along_axis(direction, axis[:, None], axis=1) < 0
            faces.update((2 * axis + side[:, 0]).tolist())
    return frozenset(faces)


def downsample(passes: PreintegrationPasses, cube: Handle, size: int) -> None:
    """Make all levels of a cube of ``size`` from its level 0."""
    for level in range(1, size.bit_length()):
        passes.cube_level(
            "downsample_cube.frag",
            cube,
            level,
            size >> level,
            TextureBinding("environment_cube", cube, CUBE_SAMPLER, level - 1),
        )
