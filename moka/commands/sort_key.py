"""The 64-bit key that orders a frame.

Correctness first: pass, layer and stage stand in the highest bits, so that
no optimisation can move a draw across them. Below them the two kinds of
draws differ, and the stage tells which one a key holds::

    bit 63    60 59   56 55 54 53      42 41        28 27    16 15       0
       +--------+-------+-----+----------+------------+--------+---------+
       |  pass  | layer |stage| program  |  material  |  mesh  |  depth  |
       |   4    |   4   |  2  |    12    |     14     |   12   |   16    |
       +--------+-------+-----+----------+------------+--------+---------+
        opaque stages: equal state together, then front to back

    bit 63    60 59   56 55 54 53                26 25     14 13         0
       +--------+-------+-----+--------------------+---------+-----------+
       |  pass  | layer |stage|   inverted depth   | program | material  |
       |   4    |   4   |  2  |         28         |   12    |    14     |
       +--------+-------+-----+--------------------+---------+-----------+
        blended stage: back to front whatever it costs

Depth is the positive distance along the view axis. Its float32 pattern,
read as an integer, grows with its value, so its upper bits are a logarithmic
quantisation: 16 bits keep 7 bits of mantissa, 28 bits keep 20, at any scale
and without knowing near and far. (The original kept ten bits of the squared
distance: two bins an octave.)

Keys sort ascending and the sort is stable: draws of equal key stay in the
order they were recorded.
"""

from enum import IntEnum
from functools import lru_cache

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import CommandError

__all__ = [
    "LAYER_BITS",
    "MATERIAL_BITS",
    "MESH_BITS",
    "PASS_BITS",
    "PROGRAM_BITS",
    "SortKey",
    "Stage",
    "blended_at",
    "opaque_at",
    "pack_blended_keys",
    "pack_opaque_keys",
    "unpack_key",
]

PASS_BITS = 4
LAYER_BITS = 4
STAGE_BITS = 2
PROGRAM_BITS = 12
MATERIAL_BITS = 14
MESH_BITS = 12
DEPTH_BITS = 16
BLENDED_DEPTH_BITS = 28

# The sign of a positive float32 is 0, which leaves 31 bits of pattern.
_DEPTH_PATTERN_BITS = 31


class Stage(IntEnum):
    """What happens within one layer of one pass, in this order."""

    SETUP = 0
    OPAQUE = 1
    BLENDED = 2
    RESOLVE = 3


class SortKey(Struct, frozen=True):
    """The fields of one key; which depth it holds depends on the stage.

    ``depth`` is in metres, not negative; blended keys have no mesh. As a
    value with ``int(key)`` it is what :meth:`CommandList.command_buffer`
    takes. Raises CommandError if a field does not fit.
    """

    pass_: int = 0
    layer: int = 0
    stage: Stage = Stage.SETUP
    program: int = 0
    material: int = 0
    mesh: int = 0
    depth: float = 0.0

    def __int__(self) -> int:
        return _pack(self)


@lru_cache(maxsize=256)  # The same few are asked for in every frame.
def _pack(key: SortKey) -> int:
    if key.stage is not Stage.BLENDED:
        return int(
            pack_opaque_keys(
                pass_=key.pass_,
                layer=key.layer,
                stage=key.stage,
                program=key.program,
                material=key.material,
                mesh=key.mesh,
                depth=key.depth,
            )
        )
    if key.mesh:
        raise CommandError("sort key: a blended key holds no mesh")
    return int(
        pack_blended_keys(
            pass_=key.pass_,
            layer=key.layer,
            program=key.program,
            material=key.material,
            depth=key.depth,
        )
    )


def pack_opaque_keys(
    *,
    pass_: ArrayLike = 0,
    layer: ArrayLike = 0,
    stage: ArrayLike = Stage.OPAQUE,
    program: ArrayLike = 0,
    material: ArrayLike = 0,
    mesh: ArrayLike = 0,
    depth: ArrayLike = 0.0,
) -> NDArray[np.uint64]:
    """Keys of opaque draws; arguments broadcast to one uint64 array.

    Raises CommandError naming the field that is out of its range.
    """
    keys: NDArray[np.uint64] = (
        _head(pass_, layer, stage)
        | (_field("program", program, PROGRAM_BITS) << np.uint64(42))
        | (_field("material", material, MATERIAL_BITS) << np.uint64(28))
        | (_field("mesh", mesh, MESH_BITS) << np.uint64(16))
    )
    return opaque_at(keys, depth)


def opaque_at(keys: NDArray[np.uint64], depth: ArrayLike) -> NDArray[np.uint64]:
    """Keys of opaque draws with their depths, for ``keys`` of depth 0.

    What a frame does, since of all fields depth alone follows the camera.
    """
    moved: NDArray[np.uint64] = keys | _depth(depth, DEPTH_BITS)
    return moved


def pack_blended_keys(
    *,
    pass_: ArrayLike = 0,
    layer: ArrayLike = 0,
    program: ArrayLike = 0,
    material: ArrayLike = 0,
    depth: ArrayLike = 0.0,
) -> NDArray[np.uint64]:
    """Keys of blended draws: the farther, the smaller.

    Arguments broadcast to one uint64 array. Raises CommandError naming the
    field that is out of its range.
    """
    nearest = np.uint64((1 << BLENDED_DEPTH_BITS) - 1)
    keys: NDArray[np.uint64] = (
        _head(pass_, layer, Stage.BLENDED)
        | (nearest << np.uint64(26))
        | (_field("program", program, PROGRAM_BITS) << np.uint64(14))
        | _field("material", material, MATERIAL_BITS)
    )
    return blended_at(keys, depth)


def blended_at(
    keys: NDArray[np.uint64], depth: ArrayLike
) -> NDArray[np.uint64]:
    """Keys of blended draws with their depths, for ``keys`` of depth 0."""
    depths = _depth(depth, BLENDED_DEPTH_BITS)
    moved: NDArray[np.uint64] = keys - (depths << np.uint64(26))
    return moved


def unpack_key(key: int) -> SortKey:
    """The fields of ``key``; the depth is the lower end of its bin."""
    key = int(key)
    stage = Stage(_bits(key, 54, STAGE_BITS))
    pass_ = _bits(key, 60, PASS_BITS)
    layer = _bits(key, 56, LAYER_BITS)
    if stage is Stage.BLENDED:
        farthest = (1 << BLENDED_DEPTH_BITS) - 1
        pattern = farthest - _bits(key, 26, BLENDED_DEPTH_BITS)
        return SortKey(
            pass_,
            layer,
            stage,
            program=_bits(key, 14, PROGRAM_BITS),
            material=_bits(key, 0, MATERIAL_BITS),
            depth=_distance(pattern, BLENDED_DEPTH_BITS),
        )
    return SortKey(
        pass_,
        layer,
        stage,
        program=_bits(key, 42, PROGRAM_BITS),
        material=_bits(key, 28, MATERIAL_BITS),
        mesh=_bits(key, 16, MESH_BITS),
        depth=_distance(_bits(key, 0, DEPTH_BITS), DEPTH_BITS),
    )


def _head(
    pass_: ArrayLike, layer: ArrayLike, stage: ArrayLike
) -> NDArray[np.uint64]:
    head: NDArray[np.uint64] = (
        (_field("pass", pass_, PASS_BITS) << np.uint64(60))
        | (_field("layer", layer, LAYER_BITS) << np.uint64(56))
        | (_field("stage", stage, STAGE_BITS) << np.uint64(54))
    )
    return head


def _field(name: str, values: ArrayLike, bits: int) -> NDArray[np.uint64]:
    array = np.asarray(values)
    if array.size:
        low, high = int(array.min()), int(array.max())
        if low < 0 or high >> bits:
            raise CommandError(
                f"sort key: {name} {low if low < 0 else high} does not fit "
                f"into {bits} bits"
            )
    return array.astype(np.uint64)


def _depth(values: ArrayLike, bits: int) -> NDArray[np.uint64]:
    # Adding zero turns -0.0, whose pattern is negative, into 0.0.
    array = np.asarray(values, np.float32) + np.float32(0.0)
    if array.size and not array.min() >= 0.0:
        raise CommandError("sort key: depth is negative or not a number")
    pattern = array.view(np.uint32).astype(np.uint64)
    shifted: NDArray[np.uint64] = pattern >> np.uint64(
        _DEPTH_PATTERN_BITS - bits
    )
    return shifted


def _distance(pattern: int, bits: int) -> float:
    word = np.uint32(pattern << (_DEPTH_PATTERN_BITS - bits))
    return float(word.view(np.float32))


def _bits(key: int, shift: int, count: int) -> int:
    return (key >> shift) & ((1 << count) - 1)
