"""Maps from the disk are those that decoding gives, to the last bit."""

import logging
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from moka.core.errors import EnvironmentMapError
from moka.core.exr import write_exr
from moka.core.radiance_hdr import write_radiance_hdr
from moka.lighting import environment
from moka.lighting.disk_cache import DiskCache
from moka.lighting.environment import Environment, load_environment
from moka.lighting.map_cache import load_map


@pytest.fixture
def cache(tmp_path: Path) -> DiskCache:
    return DiskCache(tmp_path / "cache")


def texels(height: int = 16) -> NDArray[np.float32]:
    generator = np.random.default_rng(7)
    shape = (height, 2 * height, 3)
    return generator.gamma(0.5, 2.0, shape).astype(np.float32)


def write(path: Path, pixels: NDArray[np.float32]) -> Path:
    if path.suffix == ".exr":
        write_exr(path, np.dstack([pixels, np.ones_like(pixels[:, :, :1])]))
    else:
        write_radiance_hdr(path, pixels)
    return path


def refuse_to_decode(monkeypatch: pytest.MonkeyPatch) -> None:
    def decode(path: Path) -> None:
        raise AssertionError(f"{path} has been decoded")

    monkeypatch.setattr("moka.lighting.map_cache.read_map", decode)


@pytest.mark.parametrize("suffix", [".hdr", ".exr"])
def test_the_second_time_nothing_is_decoded(
    suffix: str,
    tmp_path: Path,
    cache: DiskCache,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = write(tmp_path / f"map{suffix}", texels())
    plain = load_environment(path)
    assert plain is not None
    first, keep = load_map(path, cache)
    assert keep is not None
    keep()
    refuse_to_decode(monkeypatch)
    second, keep = load_map(path, cache)
    assert keep is None
    for found in (first, second):
        assert found.name == str(path)
        assert found.digest == plain.digest
        np.testing.assert_array_equal(
            found.pixels.view(np.uint32),
            plain.pixels.view(np.uint32),
            strict=True,
        )


def test_a_radiance_map_takes_four_bytes_a_texel(
    tmp_path: Path, cache: DiskCache
) -> None:
    _, keep = load_map(write(tmp_path / "map.hdr", texels(64)), cache)
    assert keep is not None
    keep()
    assert cache.usage().size < 64 * 128 * 4 + 1024


def test_a_file_is_known_by_its_bytes(tmp_path: Path, cache: DiskCache) -> None:
    one = write(tmp_path / "one.hdr", texels())
    _, keep = load_map(one, cache)
    assert keep is not None
    keep()
    copy = tmp_path / "copy.hdr"
    copy.write_bytes(one.read_bytes())
    found, keep = load_map(copy, cache)
    assert keep is None
    assert found.name == str(copy)
    write(one, 2 * texels())
    _, keep = load_map(one, cache)
    assert keep is not None


def test_what_is_no_radiance_is_reported_every_time(
    tmp_path: Path, cache: DiskCache, caplog: pytest.LogCaptureFixture
) -> None:
    pixels = texels()
    pixels[3, 4] = (np.nan, -1.0, -0.0)
    path = write(tmp_path / "map.exr", pixels)
    with caplog.at_level(logging.WARNING, environment.__name__):
        first, keep = load_map(path, cache)
        assert keep is not None
        keep()
        second, _ = load_map(path, cache)
    assert len(caplog.records) == 2
    assert first.pixels.tobytes() == second.pixels.tobytes()
    assert second.digest == Environment(pixels).digest


def test_a_broken_file_is_the_error_that_it_is(
    tmp_path: Path, cache: DiskCache
) -> None:
    path = tmp_path / "map.hdr"
    with pytest.raises(EnvironmentMapError, match="map"):
        load_map(path, cache)
    path.write_bytes(b"#?RADIANCE\n")
    with pytest.raises(EnvironmentMapError, match="map"):
        load_map(path, cache)
    assert cache.usage().entries == 0


def test_reading_and_finding_are_logged(
    tmp_path: Path, cache: DiskCache, caplog: pytest.LogCaptureFixture
) -> None:
    path = write(tmp_path / "map.hdr", texels())
    with caplog.at_level(logging.INFO, "moka"):
        _, keep = load_map(path, cache)
        assert keep is not None
        keep()
        load_map(path, cache)
    assert caplog.messages == [
        f"{path}: read, 32 x 16 texels",
        f"{path}: its texels are in the cache",
    ]
