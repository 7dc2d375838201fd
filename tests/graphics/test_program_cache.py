"""Programs by their descriptions, and their sources as they change."""

from collections.abc import Iterator

import pytest

from moka.backend.recording_backend import RecordingBackend
from moka.commands.descriptors import ProgramDescriptor, ShaderText
from moka.commands.handles import ResourceKind
from moka.core.errors import CommandError, ShaderError
from moka.graphics.device import GraphicsDevice
from moka.graphics.program_cache import ProgramCache


class Strict(RecordingBackend):
    """Links all but what is called broken; knows how many were begun."""

    begun: tuple[int, ...] = ()

    def finish_programs(self, handles=None):  # type: ignore[no-untyped-def]
        if handles is None:
            return
        self.begun = (*self.begun, len(handles))
        for handle in handles:
            if "broken" in self.resources[handle].fragment.source:
                raise ShaderError("a.frag:1: broken")


@pytest.fixture
def backend() -> Strict:
    return Strict()


@pytest.fixture
def device(backend: Strict) -> Iterator[GraphicsDevice]:
    with GraphicsDevice(lambda: backend) as opened:
        yield opened


def describe(sources: dict[str, str], name: str) -> ProgramDescriptor:
    return ProgramDescriptor(ShaderText("vertex"), ShaderText(sources[name]))


def test_a_key_has_one_program(device: GraphicsDevice) -> None:
    cache = ProgramCache(device)
    sources = {"a": "one", "b": "two"}
    first = cache.get("a", lambda: describe(sources, "a"))
    assert cache.get("a", lambda: describe(sources, "b")) == first
    assert cache.get("b", lambda: describe(sources, "b")) != first
    assert len(cache) == 2


def test_what_has_changed_is_compiled_anew_and_nothing_else(
    device: GraphicsDevice,
) -> None:
    cache = ProgramCache(device)
    sources = {"a": "one", "b": "two"}
    before = {
        name: cache.get(name, lambda name=name: describe(sources, name))
        for name in sources
    }
    assert cache.reload() == 0
    sources["b"] = "three"
    assert cache.reload() == 1
    assert cache.get("a", lambda: describe(sources, "a")) == before["a"]
    assert cache.get("b", lambda: describe(sources, "b")) != before["b"]
    assert device.count(ResourceKind.PROGRAM) == 2
    with pytest.raises(CommandError):
        device.destroy(before["b"])


def test_all_that_have_changed_are_compiled_side_by_side(
    device: GraphicsDevice, backend: Strict
) -> None:
    cache = ProgramCache(device)
    sources = dict.fromkeys("abc", "one")
    for name in sources:
        cache.get(name, lambda name=name: describe(sources, name))
    sources.update(a="two", c="three")
    assert cache.reload() == 2
    assert backend.begun == (2,)


def test_a_broken_one_changes_nothing(device: GraphicsDevice) -> None:
    cache = ProgramCache(device)
    sources = {"a": "one", "b": "two"}
    before = {
        name: cache.get(name, lambda name=name: describe(sources, name))
        for name in sources
    }
    sources.update(a="fine", b="broken")
    with pytest.raises(ShaderError, match="broken"):
        cache.reload()
    for name, handle in before.items():
        assert cache.get(name, lambda: describe(sources, "a")) == handle
    assert device.count(ResourceKind.PROGRAM) == 2
    sources["b"] = "mended"
    assert cache.reload() == 2
