"""The 64-bit key: round trips, ranges and the order it stands for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.commands.sort_key import (
    SortKey,
    Stage,
    pack_blended_keys,
    pack_opaque_keys,
    unpack_key,
)
from moka.core.errors import CommandError

PASSES = st.integers(0, 15)
PROGRAMS = st.integers(0, (1 << 12) - 1)
MATERIALS = st.integers(0, (1 << 14) - 1)
MESHES = st.integers(0, (1 << 12) - 1)
DEPTHS = st.floats(0, 2.0**100, width=32)
OPAQUE_STAGES = st.sampled_from([Stage.SETUP, Stage.OPAQUE, Stage.RESOLVE])


@given(PASSES, PASSES, OPAQUE_STAGES, PROGRAMS, MATERIALS, MESHES, DEPTHS)
def test_opaque_keys_round_trip(
    pass_: int,
    layer: int,
    stage: Stage,
    program: int,
    material: int,
    mesh: int,
    depth: float,
) -> None:
    key = SortKey(pass_, layer, stage, program, material, mesh, depth)
    back = unpack_key(int(key))
    assert (back.pass_, back.layer, back.stage) == (pass_, layer, stage)
    assert (back.program, back.material) == (program, material)
    assert back.mesh == mesh
    # 16 bits of pattern keep 8 of exponent and 7 of mantissa, rounded down.
    assert back.depth <= depth
    assert depth - back.depth <= max(depth * 2.0**-7, 2.0**-126)
    assert int(back) == int(key)


@given(PASSES, PASSES, PROGRAMS, MATERIALS, DEPTHS)
def test_blended_keys_round_trip(
    pass_: int, layer: int, program: int, material: int, depth: float
) -> None:
    key = SortKey(pass_, layer, Stage.BLENDED, program, material, 0, depth)
    back = unpack_key(int(key))
    assert (back.pass_, back.layer) == (pass_, layer)
    assert (back.program, back.material) == (program, material)
    assert depth - back.depth <= max(depth * 2.0**-19, 2.0**-126)


@given(st.lists(DEPTHS, min_size=2, max_size=50))
def test_blended_draws_go_back_to_front(depths: list[float]) -> None:
    keys = pack_blended_keys(depth=np.array(depths, np.float32))
    order = np.argsort(keys, kind="stable")
    quantised = [unpack_key(int(key)).depth for key in keys[order]]
    assert quantised == sorted(quantised, reverse=True)


@given(st.lists(DEPTHS, min_size=2, max_size=50))
def test_opaque_draws_of_one_state_go_front_to_back(
    depths: list[float],
) -> None:
    keys = pack_opaque_keys(depth=np.array(depths, np.float32))
    quantised = [unpack_key(int(key)).depth for key in np.sort(keys)]
    assert quantised == sorted(quantised)


def test_correctness_stands_above_optimisation() -> None:
    low = SortKey(1, 0, Stage.OPAQUE, 4095, 16383, 4095, 1e30)
    high = SortKey(1, 0, Stage.BLENDED, depth=1e30)
    later_layer = SortKey(1, 1, Stage.SETUP)
    later_pass = SortKey(2)
    keys = [int(key) for key in (low, high, later_layer, later_pass)]
    assert keys == sorted(keys)


@pytest.mark.parametrize(
    ("fields", "name"),
    [
        ({"pass_": 16}, "pass 16"),
        ({"layer": -1}, "layer -1"),
        ({"program": 1 << 12}, "program 4096"),
        ({"material": [0, 1 << 14]}, "material 16384"),
        ({"mesh": 1 << 12}, "mesh 4096"),
        ({"depth": -1.0}, "depth"),
        ({"depth": np.nan}, "depth"),
    ],
)
def test_a_field_out_of_range_is_named(
    fields: dict[str, object], name: str
) -> None:
    with pytest.raises(CommandError, match=name):
        pack_opaque_keys(**fields)


def test_infinite_depth_is_farthest_and_negative_zero_is_zero() -> None:
    near, far = pack_opaque_keys(depth=[-0.0, np.inf])
    assert unpack_key(int(near)).depth == 0.0
    assert int(far) > int(pack_opaque_keys(depth=1e38))


def test_whole_arrays_equal_single_keys() -> None:
    depth = np.linspace(0.1, 90, 7, dtype=np.float32)
    keys = pack_opaque_keys(pass_=1, program=np.arange(7), depth=depth)
    assert keys.dtype == np.uint64
    for index in range(7):
        single = SortKey(1, 0, Stage.OPAQUE, index, depth=float(depth[index]))
        assert int(keys[index]) == int(single)
