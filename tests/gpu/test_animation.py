"""Animations in pictures: times differ, still ones pay nothing."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moka
from moka.core.errors import OptionError
from tests.support.animated import AnimatedFile

pytestmark = pytest.mark.gpu

CAMERA = "orbit:0,0,6"
PLAIN = {"environment": "furnace", "size": (48, 32), "samples": 1}


def sliding() -> bytes:
    """A triangle that goes from the left to the right in a second."""
    file = AnimatedFile()
    ends = [(-2.0, -1.0, 0.0), (1.0, -1.0, 0.0)]
    file.channel((0, "translation"), [0, 1], ends, animation="slide")
    file.channel((0, "translation"), [0], ends[1:], animation="stay")
    return file.glb()


def columns(image: moka.Image) -> tuple[int, int]:
    """The first and the last column that the triangle covers."""
    covered = np.flatnonzero(image.pixels[:, :, 3].any(axis=0))
    return int(covered[0]), int(covered[-1])


def shot(
    time: float,
    animation: str | int | None = None,
    camera: moka.Camera | str = CAMERA,
) -> moka.Image:
    return moka.render(
        sliding(),
        camera=camera,
        time=time,
        animation=animation,
        background="transparent",
        **PLAIN,
    )


def test_a_picture_shows_the_pose_of_its_time() -> None:
    start, half, end = (columns(shot(time)) for time in (0, 0.5, 1))
    # The camera stays where it is while the triangle goes by.
    assert start[0] < half[0] < end[0]
    assert start[1] < half[1] < end[1]
    assert half[0] - start[0] == pytest.approx(end[0] - half[0], abs=1)
    assert columns(shot(9)) == end


def test_an_animation_is_chosen_by_name_or_position() -> None:
    camera = moka.Camera()
    camera.transform.position = (0, 0, 6)
    first = columns(shot(0, camera=camera))
    last = columns(shot(1, "slide", camera))
    assert first[1] < last[0]
    assert columns(shot(0, "slide", camera)) == first
    assert columns(shot(0, "stay", camera)) == last
    assert columns(shot(0, 1, camera)) == last


def test_an_unknown_animation_is_an_error() -> None:
    with pytest.raises(OptionError, match=r"no 'run'; .* 0 'slide', 1 'stay'"):
        shot(0, "run")
    with pytest.raises(OptionError, match="time: must be a finite number"):
        shot(float("nan"))


class Player(moka.App):
    """Plays for as many frames as it runs."""

    def load(self) -> None:
        self.model = self.scene.add(moka.load_model(sliding()))
        self.model.animations.play("slide", loop=False)
        self.scene.background = "transparent"
        self.camera.frame([(-3, -2, 0), (3, 2, 0)], 1.5)


def test_an_app_plays_frame_by_frame() -> None:
    size = PLAIN["size"]
    first, later, again = (
        moka.run(Player, headless=True, frames=frames, size=size)
        for frames in (1, 31, 31)
    )
    current = later.model.animations.current
    assert current is not None
    assert current.time == pytest.approx(0.5)
    assert columns(first.image)[0] < columns(later.image)[0]
    np.testing.assert_array_equal(later.image.pixels, again.image.pixels)


def test_a_still_model_imports_nothing_of_animation(tmp_path: Path) -> None:
    out = tmp_path / "demo.png"
    command = [sys.executable, "-X", "importtime", "-m", "moka", "render"]
    result = subprocess.run(
        [*command, "--size", "16x16", "-o", str(out)],
        capture_output=True,
        text=True,
        check=True,
    )
    names = set(re.findall(r"\| +(moka[\w.]+)$", result.stderr, re.MULTILINE))
    assert "moka.scene.scene_model" in names
    unwanted = ("anim", "keyframes", "interpol", "live_materials")
    assert not [n for n in names if any(part in n for part in unwanted)]


@pytest.mark.assets
def test_the_wheels_of_the_truck_turn(assets: Path) -> None:
    truck = assets / "models" / "CesiumMilkTruck.glb"
    pixels = [
        moka.render(
            truck,
            time=time,
            camera="orbit:90,0",
            environment="furnace",
            size=(96, 64),
        ).pixels
        for time in (0.0, 0.3)
    ]
    different = (np.abs(pixels[0] - pixels[1]) > 1e-3).any(axis=-1)
    rows, columns_ = np.nonzero(different)
    # Two wheels, in the lower half; the rest stands still.
    assert 20 < different.sum() < 0.2 * different.size
    assert rows.min() > 32
    assert np.ptp(columns_) > 20


@pytest.mark.assets
@pytest.mark.parametrize(
    ("name", "animation", "times", "share"),
    [
        ("Soldier.glb", "Run", (0.2, 0.45), 0.03),
        ("Michelle.glb", "SambaDance", (3.0, 7.0), 0.03),
        ("MorphStressTest.gltf", "TheWave", (0.3, 0.9), 0.01),
    ],
)
def test_characters_and_morphs_move(
    assets: Path,
    name: str,
    animation: str,
    times: tuple[float, float],
    share: float,
) -> None:
    first, second = (
        moka.render(
            assets / "models" / name,
            animation=animation,
            time=time,
            environment="furnace",
            size=(64, 64),
            samples=1,
        ).pixels
        for time in times
    )
    different = (np.abs(first - second) > 0.02).any(axis=-1)
    assert different.mean() > share


def test_a_pose_that_is_held_is_written_once() -> None:
    class Held(moka.App):
        def load(self) -> None:
            self.model = self.scene.add(moka.load_model(sliding()))
            self.model.animations.pose("slide", 0.5)
            self.versions: list[tuple[int, int]] = []

        def update(self, time: moka.GameTime) -> None:  # noqa: ARG002
            self.scene.update()
            row = int(self.model.rows[0])
            transforms = self.scene.transforms
            self.versions.append((transforms.version, transforms.edits(row)))

    app = moka.run(Held, headless=True, frames=5, size=(16, 16))
    assert isinstance(app, Held)
    assert len(set(app.versions)) == 1
    assert not app.scene.is_animating
