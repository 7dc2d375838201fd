"""``moka info``: the file, and what a picture needs of it."""

import json
from pathlib import Path

import pytest

from moka.cli.main import main
from tests.support.gltf_file import GltfFile


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Two scenes, and three instances of a mesh in the first."""
    file = GltfFile()
    places = file.accessor([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    file.node(
        mesh=file.quad(material=file.unlit(1, 1, 1, 1)),
        extensions={
            "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}
        },
    )
    hidden = {"KHR_node_visibility": {"visible": False}}
    file.node(mesh=0, extensions=hidden)
    file.document["scenes"] = [
        {"nodes": [0], "name": "day"},
        {"nodes": [1], "name": "night"},
    ]
    made = tmp_path / "rooms.glb"
    made.write_bytes(file.glb())
    return made


def test_what_a_file_holds(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["info", str(path)]) == 0
    text = capsys.readouterr().out
    assert "nodes       2, 3 instances of their meshes, 1 hidden\n" in text
    assert "a picture   of 1280x720 makes 3 of 3 draws\n" in text
    assert "not in its scene: 1 nodes\n" in text


def test_of_another_picture(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--scene", "night", "--size", "64x32", "--json"]
    assert main(["info", str(path), *options]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["default_scene"] == 1
    assert printed["picture"]["size"] == [64, 32]
    assert printed["picture"]["draws"]["hidden"] == 1
    assert printed["required_extensions"] == []


def test_a_scene_that_is_not_there(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["info", str(path), "--scene", "noon"]) == 2
    assert capsys.readouterr().err == (
        f"moka: error: {path}: there is no scene 'noon'; choose from 0 'day', "
        "1 'night'\n"
    )
