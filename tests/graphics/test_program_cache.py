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
    """Compiles all but what is called broken."""

    def create_program(self, handle, descriptor):  # type: ignore[no-untyped-def]
        if "broken" in descriptor.fragment.source:
            raise ShaderError("a.frag:1: broken")
        super().create_program(handle, descriptor)


@pytest.fixture
def device() -> Iterator[GraphicsDevice]:
    with GraphicsDevice(Strict) as opened:
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
