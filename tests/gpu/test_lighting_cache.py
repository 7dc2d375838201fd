"""Cached lighting: found again, the same to the last bit, never required."""

import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moka
from moka.app.render_request import request_of
from moka.app.render_session import RenderSession
from moka.cli.main import main
from moka.core.statistics import Statistics
from moka.lighting.code_digest import code_digest
from moka.lighting.environment import Environment, Sun
from moka.material.material import Material
from moka.model import model_of, sphere

pytestmark = pytest.mark.gpu

SIZE = (40, 40)


def uneven(seed: int = 0, *, suns: bool = False) -> Environment:
    """Random radiance, with a sun in the map and one of its own."""
    pixels = np.random.default_rng(seed).random((32, 64, 3), np.float32)
    if suns:
        pixels[7, 30] = 4000.0
        return Environment(pixels, (Sun((0.6, 0.8, 0.0), (1.0, 0.9, 0.7)),))
    return Environment(pixels)


def ball() -> moka.Model:
    material = Material(metallic_factor=0.5, roughness_factor=0.4)
    return model_of([(sphere(), material, np.eye(4))])


def pixels(**options: Any) -> np.ndarray:
    options.setdefault("environment", uneven())
    image = moka.render(ball(), size=SIZE, samples=1, **options)
    assert image.pixels is not None
    return image.pixels


def entries() -> dict[str, int]:
    folder = Path(os.environ["MOKA_CACHE_DIR"])
    return {path.name: path.stat().st_ino for path in folder.glob("*")}


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"environment": uneven(suns=True)},
        {"environment": uneven(suns=True), "suns": 1},
        {"environment": uneven(suns=True), "suns": "off"},
        {"environment": uneven(suns=True), "background": "transparent"},
        {"irradiance": "cube"},
        {"irradiance": "sh", "environment_rotation": 1.0},
        {"ibl": "filtered", "ibl_samples": 4},
        {"brdf": "karis", "diffuse": "burley"},
        {"environment": "studio"},
    ],
    ids=str,
)
def test_pictures_are_the_same_to_the_last_bit(options: dict[str, Any]) -> None:
    without = pixels(cache=False, **options)
    assert not entries()
    making = pixels(**options)
    made = entries()
    assert made
    finding = pixels(**options)
    assert entries() == made  # nothing is written twice
    np.testing.assert_array_equal(making, without)
    np.testing.assert_array_equal(finding, without)


def test_other_light_is_another_entry() -> None:
    pixels()
    made = set(entries())
    for options in (
        {"environment": uneven(1)},
        {"suns": 2},
        {"irradiance": "cube"},
        {
            "environment": Environment(
                uneven().pixels, (Sun((0, 1, 0), (1,) * 3),)
            )
        },
    ):
        pixels(**options)
        assert made < set(entries())
        made = set(entries())
    for options in (
        {"environment_rotation": 2.0},
        {"environment_intensity": 3.0},
        {"exposure": 1.0},
        {"diffuse": "burley"},
    ):
        pixels(**options)
        assert set(entries()) == made


@pytest.mark.parametrize("environment", ["furnace", "none"])
def test_what_takes_no_time_is_not_kept(environment: str) -> None:
    pixels(environment=environment)
    folder = Path(os.environ["MOKA_CACHE_DIR"])
    assert not list(folder.glob("*"))


@pytest.mark.skipif(sys.platform != "linux", reason="/proc tells")
def test_what_has_been_found_lets_go_of_its_files() -> None:
    """They are mapped into memory, of which they are as much as a texture."""
    request = request_of(ball(), environment=uneven(), size=SIZE)
    for found in (False, True):
        statistics = Statistics()
        with RenderSession.open(request, statistics, cache=True) as session:
            session.submit(want_pixels=False, want_display=True).wait()
            session.report()
            assert statistics.lighting["cached"] is found
            maps = Path("/proc/self/maps").read_text(encoding="utf-8")
            assert ".lighting" not in maps
            session.keep_lighting()


def test_a_damaged_entry_is_replaced() -> None:
    expected = pixels()
    folder = Path(os.environ["MOKA_CACHE_DIR"])
    whole = {path.name: path.read_bytes() for path in folder.glob("*")}
    for name, content in whole.items():
        broken = bytearray(content)
        broken[len(broken) // 2] ^= 0x40
        (folder / name).write_bytes(broken)
    np.testing.assert_array_equal(pixels(), expected)
    for name, content in whole.items():
        assert (folder / name).read_bytes() == content


def test_a_cache_that_cannot_be_written_changes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = pixels(cache=False)
    blocked = tmp_path / "file"
    blocked.write_text("no folder")
    monkeypatch.setenv("MOKA_CACHE_DIR", str(blocked))
    np.testing.assert_array_equal(pixels(), expected)
    assert blocked.read_text() == "no folder"


def test_lighting_made_otherwise_is_not_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pixels()
    made = set(entries())
    monkeypatch.setattr(
        "moka.lighting.lighting_cache.code_digest", lambda: "other code"
    )
    pixels()
    assert len(entries()) == 2 * len(made)
    assert len(code_digest()) == 128


def test_the_command_line(tmp_path: Path) -> None:
    def rendered(*options: str) -> dict[str, Any]:
        statistics = tmp_path / "statistics.json"
        arguments = ["render", "--size", "24x16", "-o", str(tmp_path / "a.png")]
        arguments += ["--stats", str(statistics), *options]
        assert main(arguments) == 0
        found: dict[str, Any] = json.loads(statistics.read_text())
        return found

    without = rendered("--no-cache")
    assert not entries()
    making = rendered()
    made = entries()
    assert made
    found = rendered()
    ignoring = rendered("--no-cache")
    assert entries() == made
    assert [
        run["lighting"]["cached"] for run in (without, making, found, ignoring)
    ] == [False, False, True, False]
    assert [
        "store" in run["stages_ms"] for run in (without, making, found)
    ] == [False, True, False]


def test_a_loop_keeps_the_light_of_every_environment() -> None:
    class Loop(moka.App):
        def load(self) -> None:
            self.scene.add(ball())

        def update(self, time: moka.GameTime) -> None:
            self.scene.environment = uneven(time.frame)

    moka.run(Loop, headless=True, frames=3, size=SIZE, cache=False)
    assert not entries()
    moka.run(Loop, headless=True, frames=3, size=SIZE)
    assert len(entries()) == 3
