"""``moka validate``: what it prints, and how it ends."""

import json
from pathlib import Path

import pytest

from moka.cli.main import main
from tests.model.validation.faults import FAULTS, whole


def written(folder: Path, fault: str | None = None) -> Path:
    path = folder / "model.glb"
    path.write_bytes(whole(FAULTS[fault] if fault else None))
    return path


def test_a_valid_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path)
    assert main(["validate", str(path)]) == 0
    assert capsys.readouterr().out == (
        f"{path}: valid: 0 errors, 0 warnings, 0 remarks\n"
    )


def test_a_warning_leaves_a_file_valid(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, "cutoff without a mask")
    assert main(["validate", str(path)]) == 0
    line, summary = capsys.readouterr().out.splitlines()
    assert line == (
        "warning: materials[0].alphaCutoff: has a meaning only for alphaMode "
        "MASK (MATERIAL_ALPHA_CUTOFF_INVALID_MODE)"
    )
    assert summary.endswith("valid: 0 errors, 1 warnings, 0 remarks")


def test_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, "mesh out of range")
    assert main(["validate", str(path), "--json"]) == 1
    printed = json.loads(capsys.readouterr().out)
    assert printed["valid"] is False
    assert printed["counts"]["error"] == len(printed["issues"]) == 2
    assert printed["issues"][0] == {
        "code": "UNRESOLVED_REFERENCE",
        "severity": "error",
        "path": "nodes[0].mesh",
        "message": "there is no meshes[9], the file has 2",
    }


def test_many_of_a_kind_are_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "model.gltf"
    nodes = [{"mesh": 9}] * 12
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "nodes": nodes}))
    assert main(["validate", str(path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line[:16] for line in lines[:5]] == [
        f"error: nodes[{number}]." for number in range(5)
    ]
    assert lines[5] == "    and 7 more of UNRESOLVED_REFERENCE; see --all"
    assert main(["validate", str(path), "--all"]) == 1
    everything = capsys.readouterr().out.splitlines()
    assert sum("UNRESOLVED_REFERENCE" in line for line in everything) == 12


def test_a_file_that_cannot_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "gone.glb"
    assert main(["validate", str(path)]) == 2
    assert capsys.readouterr().err == f"moka: error: {path}: no such file\n"
