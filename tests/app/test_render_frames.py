"""Sequences: what moves, and that each frame is the picture it stands for."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

import moka
from moka.cli import main
from moka.core.errors import OptionError
from moka.material.material import Material
from moka.model import cube, model_of, save_model
from moka.scene.camera import Camera

pytestmark = pytest.mark.gpu

SIZE = (32, 24)


def block() -> moka.Model:
    """A cube that is not in the middle of the world."""
    place = np.diag([1.0, 2.0, 0.5, 1.0])
    place[:3, 3] = 3, 1, -2
    return model_of([(cube(1.0), Material(metallic_factor=0.0), place)])


def test_frames_of_a_turntable_are_pictures_from_around() -> None:
    frames = list(
        moka.render_frames(
            block(), frames=4, turntable=True, size=SIZE, camera="orbit:10,20"
        )
    )
    assert len(frames) == 4
    for number, frame in enumerate(frames):
        camera = Camera()
        camera.frame(
            block().bounds(),
            SIZE[0] / SIZE[1],
            math.radians(10 + 90 * number),
            math.radians(20),
        )
        still = moka.render(
            block(), size=SIZE, camera=camera, full_textures=True
        )
        np.testing.assert_allclose(frame.pixels, still.pixels, atol=2e-4)
        assert np.abs(frame.pixels - frames[number - 1].pixels).max() > 0.05


@pytest.mark.assets
def test_frames_of_an_animation_are_its_poses(assets: Path) -> None:
    """The truck's wheels turn, and begin again."""
    truck = assets / "models" / "CesiumMilkTruck.glb"
    duration = moka.load_model(truck).animations[0].duration
    options = {"size": SIZE, "camera": "orbit:30,10"}
    frames = list(
        moka.render_frames(
            truck,
            frames=3,
            frames_per_second=2 / duration,
            time=0.25 * duration,
            **options,
        )
    )
    for frame, part in zip(frames, (0.25, 0.75, 0.25), strict=True):
        still = moka.render(
            truck, time=part * duration, full_textures=True, **options
        )
        np.testing.assert_allclose(frame.pixels, still.pixels, atol=2e-3)


def test_what_moves_not_is_an_error() -> None:
    with pytest.raises(OptionError, match="nothing moves"):
        next(moka.render_frames(block(), frames=3, size=SIZE))
    for options in (
        {"frames": 0},
        {"frames": 3, "frames_per_second": 0.0},
    ):
        with pytest.raises(OptionError):
            next(moka.render_frames(block(), turntable=True, **options))


def test_an_iterator_that_is_left_early_closes_its_device() -> None:
    frames = moka.render_frames(block(), frames=1000, turntable=True, size=SIZE)
    assert next(frames).size == SIZE
    frames.close()


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "block.glb"
    save_model(block(), path)
    return path


def test_the_command_writes_frames_and_goes_on(
    tmp_path: Path, model: Path
) -> None:
    statistics = tmp_path / "stats.json"
    command = [
        *("render", str(model), "--frames", "3", "--turntable"),
        *("--size", "32x24", "--no-cache", "--stats", str(statistics)),
        *("-o", str(tmp_path / "out.png"), "-o", str(tmp_path / "out.exr")),
    ]
    assert main(command) == 0
    paths = [tmp_path / f"out.000{number}.png" for number in range(3)]
    before = [path.read_bytes() for path in paths]
    assert len({*before}) == 3
    assert all(path.with_suffix(".exr").exists() for path in paths)
    all_draws = json.loads(statistics.read_text())["counts"]["gl_draws"]

    paths[1].unlink()
    stamps = [path.stat().st_mtime_ns for path in (paths[0], paths[2])]
    assert main([*command, "--resume"]) == 0
    assert [path.read_bytes() for path in paths] == before
    assert stamps == [path.stat().st_mtime_ns for path in (paths[0], paths[2])]
    few_draws = json.loads(statistics.read_text())["counts"]["gl_draws"]
    assert few_draws < all_draws


def test_the_command_writes_a_moving_picture(
    tmp_path: Path, model: Path
) -> None:
    output = tmp_path / "out.gif"
    command = [
        *("render", str(model), "--turntable", "--frames", "5", "--fps", "25"),
        *("--size", "32x24", "-o", str(output)),
    ]
    assert main(command) == 0
    with PillowImage.open(output) as gif:
        assert gif.n_frames == 5
        assert gif.info["duration"] == 40


def test_mistakes_are_one_line(
    tmp_path: Path, model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for options, text in (
        (["-o", "a.avi"], "the ending .png or .exr"),
        (["--frames", "2", "-o", "a.png"], "nothing moves"),
        (["--fps", "20", "-o", "a.png"], "--fps: needs --frames"),
        (
            ["--turntable", "--resume", "-o", "a.gif"],
            "cannot be resumed",
        ),
        (
            ["--turntable", "--fps", "100", "-o", "a.gif"],
            "50 frames per second at most",
        ),
        (["--turntable", "--size", "31x24", "-o", "a.mp4"], "even width"),
    ):
        given = [
            str(tmp_path / option) if option.startswith("a.") else option
            for option in options
        ]
        assert main(["render", str(model), *given]) == 2
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1
        assert text in lines[0]
    assert [path.name for path in tmp_path.iterdir()] == ["block.glb"]
