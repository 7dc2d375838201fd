"""From an equirectangular map to a cube of radiance and its levels."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    TextureBinding,
    TextureDescriptor,
    TextureKind,
    Wrap,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment_maps import (
    CUBE_FORMAT,
    MAP_SAMPLER,
)
from moka.lighting.equirectangular import uv_to_direction
from moka.lighting.preintegration_passes import (
    CUBE_FACES,
    PreintegrationPasses,
)
from moka.lighting.specular_cube import SMALLEST_SPECULAR

__all__ = [
    "cube_size",
    "downsample",
    "faces_that_differ",
    "map_to_cube",
    "uniform_cube",
]

LARGEST_CUBE = 1024

# A level is made of texels of the one above, each read in its centre.
_TEXELS = SamplerDescriptor(
    Wrap.CLAMP_TO_EDGE,
    Wrap.CLAMP_TO_EDGE,
    Filter.NEAREST,
    Filter.NEAREST,
    MipmapMode.NONE,
)


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
    *,
    faces: Sequence[int] = CUBE_FACES,
    fine: bool,
) -> None:
    """Resample a map of ``map_height`` rows into level 0 of ``cube``.

    Into ``faces``, all or one. A texel is the mean of four samples if
    ``fine``, or one bilinear sample, which for what is even is as good; of
    more, if it covers several texels of a large map.
    """
    subdivisions = max(1 + fine, -(-map_height // (2 * size)))
    passes.cube_level(
        "equirectangular_to_cube.frag",
        cube,
        0,
        size,
        TextureBinding("environment_map", map_texture, MAP_SAMPLER),
        defines={"MOKA_SIZE": size, "MOKA_SUBDIVISIONS": subdivisions},
        faces=faces,
        reads=subdivisions**2,
    )


def faces_that_differ(
    one: NDArray[np.float32], other: NDArray[np.float32]
) -> frozenset[int]:
    """The faces of a cube on which two maps (H, W, 3) are not the same.

    With the neighbours of each texel, which bilinear sampling reads.
    """
    height, width, channels = one.shape
    # Not any() of the channels, which takes twenty times as long.
    texels = np.flatnonzero(one != other) // channels
    rows, columns = np.divmod(texels, width)
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
            TextureBinding("environment_cube", cube, _TEXELS, level - 1),
            defines={},
            reads=4,
        )
