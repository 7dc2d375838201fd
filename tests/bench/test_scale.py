"""``moka bench scale``: scenes that grow as they say, and what is told."""

import json
from pathlib import Path

import numpy as np
import pytest

from moka.bench.character_scenes import (
    of_characters,
    of_standing,
    of_statues,
)
from moka.bench.scale import SIZES
from moka.bench.scale_scenes import (
    Subject,
    of_lights,
    of_materials,
    of_objects,
    of_textures,
    of_visible,
)
from moka.cli.main import main


def visible(subject: Subject) -> int:
    subject.advance(0)
    subject.scene.update()
    return int(np.count_nonzero(subject.scene.visible(subject.camera, 1.0)))


def materials(subject: Subject) -> int:
    subject.scene.update()
    primitives = subject.scene.drawables.primitives
    return len({id(primitive.material) for primitive in primitives})


@pytest.mark.parametrize("count", [1, 10, 64, 1000])
def test_all_objects_are_there_and_seen(count: int) -> None:
    subject = of_objects(count)
    assert visible(subject) == len(subject.scene.drawables) == count
    assert materials(subject) == min(count, 16)


def test_half_of_the_objects_leave_the_picture() -> None:
    assert visible(of_visible(100, 1000)) == 1000
    # Those on the edge are seen in part.
    assert 500 <= visible(of_visible(50, 1000)) < 600


def test_materials_and_lights_are_as_many_as_asked_for() -> None:
    assert materials(of_materials(7, 20)) == 7
    subject = of_lights(5)
    subject.scene.update()
    assert len(subject.scene.light_rows()) == 5


def test_textures_are_four_and_of_no_one_colour() -> None:
    scene = of_textures(64).scene
    scene.update()
    (primitive,) = scene.drawables.primitives
    assert primitive.material is not None
    images = [texture.image for texture in primitive.material.textures]
    assert len({image.identity for image in images}) == 4


@pytest.mark.gpu
def test_series_grow_and_exponents_are_fitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "scale.json"
    arguments = ["bench", "scale", "--series", "objects,textures"]
    arguments += ["--largest", "100", "--widest", "256", "--frames", "2"]
    assert main([*arguments, "--json", str(out)]) == 0
    series = json.loads(out.read_text())["series"]
    objects = series["objects"]
    assert [point["size"] for point in objects["points"]] == [10, 100]
    assert [point["counts"]["objects"] for point in objects["points"]] == [
        10,
        100,
    ]
    assert set(objects["exponents"]) == {"frame_ms", "submit_ms", "prepare_ms"}
    assert [point["size"] for point in series["textures"]["points"]] == [256]
    assert series["textures"]["exponents"] == {}
    said = capsys.readouterr().out
    assert "time grows as objects" in said
    assert "time grows as textures" not in said


def test_an_unknown_series_is_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["bench", "scale", "--series", "objects,clouds"]) == 2
    message = capsys.readouterr().err
    assert "clouds" in message
    assert all(name in message for name in SIZES)


def test_crowds_differ_only_in_what_moves() -> None:
    moving, still, rigid = (
        make(4) for make in (of_characters, of_standing, of_statues)
    )
    for subject in (moving, still, rigid):
        assert visible(subject) == 4
    np.testing.assert_allclose(
        still.scene.bounds(), rigid.scene.bounds(), rtol=1e-6
    )
    versions = []
    for subject in (moving, still):
        first = subject.scene.pose_version
        subject.advance(1)
        subject.scene.update()
        versions.append(subject.scene.pose_version - first)
    assert versions == [1, 0]
    assert rigid.scene.drawables.poses is None
