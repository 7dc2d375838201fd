"""Environments: where they come from, and texels that are no radiance."""

import logging
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from moka.core.errors import EnvironmentMapError
from moka.core.exr import write_exr
from moka.core.radiance_hdr import write_radiance_hdr
from moka.lighting.environment import Environment, Sun, load_environment


def radiance(height: int = 4) -> np.ndarray:
    random = np.random.default_rng(0)
    values = random.uniform(0.0, 9.0, (height, 2 * height, 3))
    return values.astype(np.float32)


def test_furnace_is_one_everywhere() -> None:
    furnace = load_environment("furnace")
    assert furnace is not None
    assert furnace.is_uniform
    assert furnace.pixels.tolist() == [[[1.0, 1.0, 1.0]]]
    assert not furnace.suns


def test_none_is_none() -> None:
    assert load_environment("none") is None


@pytest.mark.parametrize("name", ["studio", "sky"])
def test_built_in_is_made_once(name: str) -> None:
    environment = load_environment(name)
    assert environment is load_environment(name)
    assert environment is not None
    assert environment.name == name
    assert not environment.is_uniform


@pytest.mark.parametrize("suffix", [".hdr", ".HDR", ".pic"])
def test_radiance_file(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"map{suffix}"
    write_radiance_hdr(path, radiance())
    for source in (path, str(path)):
        environment = load_environment(source)
        assert environment is not None
        assert environment.name == str(path)
        # RGBE keeps eight bits of the largest channel.
        step = radiance().max(axis=2, keepdims=True) / 128.0
        assert (np.abs(environment.pixels - radiance()) <= step).all()


@pytest.mark.parametrize("channels", [3, 4])
def test_exr_file(tmp_path: Path, channels: int) -> None:
    pixels = np.ones((4, 8, channels), np.float32)
    pixels[:, :, :3] = radiance()
    write_exr(tmp_path / "map.exr", pixels)
    environment = load_environment(tmp_path / "map.exr")
    assert environment is not None
    np.testing.assert_array_equal(environment.pixels, radiance())
    assert environment.pixels.flags.c_contiguous


def test_array_becomes_read_only_and_single() -> None:
    environment = load_environment(radiance().astype(np.float64))
    assert environment is not None
    assert environment.pixels.dtype == np.float32
    with pytest.raises(ValueError, match="read-only"):
        environment.pixels[0, 0] = 0.0
    own = radiance()
    Environment(own)
    own[0, 0] = 1.0  # what was given stays writable


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("missing.hdr", "No such file"),
        ("missing.exr", "no such file"),
        ("map.jpg", r"\.hdr, \.pic or \.exr file, or one of studio, sky"),
        ("stdio", "studio, sky, furnace, none"),
        ("broken.hdr", "begin"),
        ("broken.exr", "begin"),
        ("square.hdr", "7 x 7 .* twice as wide as high"),
    ],
)
def test_what_is_no_environment_is_named(
    tmp_path: Path, source: str, reason: str
) -> None:
    (tmp_path / "broken.hdr").write_bytes(b"not one")
    (tmp_path / "broken.exr").write_bytes(b"not one")
    write_radiance_hdr(tmp_path / "square.hdr", np.ones((7, 7, 3)))
    with pytest.raises(EnvironmentMapError, match=reason) as error:
        load_environment(tmp_path / source)
    assert str(error.value).startswith(f"{tmp_path / source}: ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "shape", [(4, 8), (4, 8, 4), (4, 7, 3), (0, 0, 3), (2, 1, 3)]
)
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(EnvironmentMapError, match=r"^my map: .*"):
        Environment(np.zeros(shape), name="my map")


def test_texels_that_are_no_radiance_are_replaced_and_reported(
    caplog: pytest.LogCaptureFixture,
) -> None:
    pixels = radiance().astype(np.float64)
    expected = pixels.copy()
    wrong = [math.nan, -math.nan, math.inf, -math.inf, -3.0, 1e300]
    right = [0.0, 0.0, 65504.0, 0.0, 0.0, 65504.0]
    pixels[1, :6, 2] = wrong
    expected[1, :6, 2] = right
    with caplog.at_level(logging.WARNING):
        environment = Environment(pixels, name="my map")
    np.testing.assert_array_equal(
        environment.pixels, expected.astype(np.float32)
    )
    [message] = [record.getMessage() for record in caplog.records]
    assert message.startswith("my map: 6 of 32 texels")


def test_bright_texels_stay(caplog: pytest.LogCaptureFixture) -> None:
    pixels = np.zeros((2, 4, 3))
    pixels[0, 0] = [1e9, 1e30, 1e-40]
    environment = Environment(pixels)
    np.testing.assert_array_equal(environment.pixels, pixels.astype(np.float32))
    assert not caplog.records


def test_uniform_environment() -> None:
    environment = Environment.uniform((1.0, 2.0, 3.0))
    assert environment.is_uniform
    assert environment.pixels.tolist() == [[[1.0, 2.0, 3.0]]]


def test_sun_has_a_direction_of_unit_length() -> None:
    assert Sun((0.6, 0.8, 0.0), (1.0, 1.0, 1.0)).direction == (0.6, 0.8, 0.0)
    with pytest.raises(ValueError, match="unit vector"):
        Sun((1.0, 1.0, 0.0), (1.0, 1.0, 1.0))


def test_only_what_is_asked_for_is_imported() -> None:
    check = (
        "import sys; from moka.lighting.environment import load_environment;"
        "load_environment('furnace');"
        "sys.exit(any(name in sys.modules for name in ("
        "'PIL', 'OpenEXR', 'moka.lighting.studio', 'moka.core.exr')))"
    )
    subprocess.run([sys.executable, "-c", check], check=True)


@pytest.mark.assets
def test_real_map_has_its_sun_and_its_ground(assets: Path) -> None:
    environment = load_environment(
        assets / "environments" / "spiaggia_di_mondello_1k.hdr"
    )
    assert environment is not None
    pixels = environment.pixels
    assert pixels.shape == (512, 1024, 3)
    sun = np.unravel_index(pixels.sum(axis=2).argmax(), pixels.shape[:2])
    assert sun[0] < 256  # above the horizon
    assert pixels[0, :, 2].mean() > pixels[0, :, 0].mean()  # a blue zenith
