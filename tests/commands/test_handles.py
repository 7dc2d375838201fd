"""Handles are generational: stale ones are told apart and refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.commands.handles import HandleAllocator, ResourceKind
from moka.core.errors import CommandError


def test_a_destroyed_handle_is_refused_after_its_slot_is_reused() -> None:
    handles = HandleAllocator(device=0)
    old = handles.allocate(ResourceKind.MESH)
    handles.release(old)
    new = handles.allocate(ResourceKind.MESH)
    assert new.index == old.index
    assert new != old
    handles.check(new, ResourceKind.MESH)
    with pytest.raises(CommandError, match="used after it was destroyed"):
        handles.check(old)


def test_double_destroy_is_an_error() -> None:
    handles = HandleAllocator(device=0)
    handle = handles.allocate(ResourceKind.BUFFER)
    handles.release(handle)
    with pytest.raises(CommandError, match="destroyed"):
        handles.release(handle)


def test_another_devices_handle_is_an_error() -> None:
    handle = HandleAllocator(device=3).allocate(ResourceKind.TEXTURE)
    with pytest.raises(CommandError, match="belongs to device 3"):
        HandleAllocator(device=4).check(handle)


def test_the_wrong_kind_is_an_error() -> None:
    handles = HandleAllocator(device=0)
    handle = handles.allocate(ResourceKind.TEXTURE)
    with pytest.raises(CommandError, match="expected a mesh handle"):
        handles.check(handle, ResourceKind.MESH)


@given(st.lists(st.tuples(st.booleans(), st.integers(0, 9)), max_size=60))
def test_no_two_live_handles_are_equal(steps: list[tuple[bool, int]]) -> None:
    handles = HandleAllocator(device=0)
    live = []
    seen = set()
    for creates, position in steps:
        if creates or not live:
            handle = handles.allocate(ResourceKind.MESH)
            assert handle not in seen
            seen.add(handle)
            live.append(handle)
        else:
            handles.release(live.pop(position % len(live)))
    assert all(handles.is_alive(handle) for handle in live)
    assert handles.count(ResourceKind.MESH) == len(live)
