"""Agreement with the validator of the Khronos Group, where Node can run it."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from moka.model.validation.issues import Severity
from moka.model.validation.validate import validate
from tests.conformance.features import FEATURES
from tests.model.validation.faults import FAULTS, whole

# What is not told twice: codes that follow from a fault that we do tell.
FOLLOWING = {
    "string for a number": {
        "ACCESSOR_INDEX_OOB",
        "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
    },
    "count of nothing": {
        "ACCESSOR_INDEX_OOB",
        "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
    },
    "unknown component type": {
        "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    },
    "no component type": {
        "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    },
    "bounds of a wrong length": {
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS"
    },
    "inverse matrices of a wrong type": {"BUFFER_VIEW_TARGET_OVERRIDE"},
}
# The validator itself fails on this one.
BEYOND_IT = {"number in a list of objects"}

# What it has not heard of: JPEGs of four channels, KTX2 and AVIF. And what it
# alone tells: that a colour profile means nothing.
UNREAD = {
    "Forms of images": {"IMAGE_DATA_INVALID", "IMAGE_FEATURES_UNSUPPORTED"},
    "KHR_texture_basisu": {"IMAGE_UNRECOGNIZED_FORMAT", "VALUE_NOT_IN_LIST"},
    "EXT_texture_avif": {"IMAGE_UNRECOGNIZED_FORMAT", "VALUE_NOT_IN_LIST"},
}

PACKAGE = "gltf-validator@2.0.0-dev.3.10"

SCRIPT = """
const fs = require('fs'), path = require('path');
const validator = require('gltf-validator');
(async () => {
  const found = {};
  for (const file of JSON.parse(fs.readFileSync(0, 'utf8'))) {
    const read = uri => fs.promises
      .readFile(path.join(path.dirname(file), decodeURIComponent(uri)))
      .then(data => new Uint8Array(data));
    try {
      const report = await validator.validateBytes(
        new Uint8Array(fs.readFileSync(file)),
        {uri: path.basename(file), maxIssues: 0,
         externalResourceFunction: read});
      found[file] = report.issues.messages.map(
        each => [each.code, each.severity, each.pointer || '']);
    } catch (error) { found[file] = null; }
  }
  console.log(JSON.stringify(found));
})();
"""

Issues = set[tuple[str, str]]


@pytest.fixture(scope="module")
def khronos(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Runs the validator on files; skipped where it cannot be installed."""
    npm, node = shutil.which("npm"), shutil.which("node")
    if npm is None or node is None:
        pytest.skip("needs Node and npm for the Khronos glTF validator")
    folder = tmp_path_factory.mktemp("validator")
    install = [npm, "install", "--silent", "--no-audit", "--no-fund"]
    try:
        subprocess.run(
            [
                *install,
                "--prefix",
                str(folder),
                PACKAGE,
            ],
            check=True,
            capture_output=True,
            timeout=120,
        )
    except (subprocess.SubprocessError, OSError) as error:
        pytest.skip(f"the Khronos glTF validator cannot be installed: {error}")
    script = folder / "run.js"
    script.write_text(SCRIPT)

    def run(files: list[Path]) -> dict[Path, Issues | None]:
        finished = subprocess.run(
            [node, str(script)],
            input=json.dumps([str(file) for file in files]),
            check=True,
            capture_output=True,
            text=True,
            timeout=120,
        )
        found = json.loads(finished.stdout)
        return {
            file: None
            if found[str(file)] is None
            else {
                (code, as_path(pointer))
                for code, severity, pointer in found[str(file)]
                if severity < 2  # Errors and warnings.
            }
            for file in files
        }

    return run


def as_path(pointer: str) -> str:
    """A JSON pointer as our JSON path."""
    text = ""
    for step in filter(None, pointer.split("/")):
        if step.isdecimal():
            text += f"[{step}]"
        else:
            text += f".{step}" if text else step
    return text


def ours(file: Path) -> Issues:
    return {
        (issue.code, issue.path)
        for issue in validate(file).issues
        if issue.severity is not Severity.INFORMATION
    }


def test_on_every_fault(khronos: Any, tmp_path: Path) -> None:
    files = {}
    for number, (name, fault) in enumerate(FAULTS.items()):
        files[name] = tmp_path / f"{number}.glb"
        files[name].write_bytes(whole(fault))
    theirs = khronos(list(files.values()))
    assert len(files) > 100
    for name, file in files.items():
        found = theirs[file]
        assert (found is None) == (name in BEYOND_IT), name
        if found is None:
            continue
        told = ours(file)
        assert told <= found, (name, told - found)
        left = {code for code, _ in found - told}
        assert left == FOLLOWING.get(name, set()), name


@pytest.mark.assets
def test_on_the_samples(khronos: Any, assets: Path) -> None:
    files = sorted((assets / "models").rglob("*.gl[bt]*"))
    theirs = khronos(files)
    assert len(files) > 10
    for file in files:
        assert ours(file) == theirs[file], file.name


def test_on_every_feature(khronos: Any, tmp_path: Path) -> None:
    cases = [case for cases in FEATURES.values() for case in cases]
    files = [tmp_path / f"{number}.glb" for number in range(len(cases))]
    for case, file in zip(cases, files, strict=True):
        file.write_bytes(case.glb())
    theirs = khronos(files)
    for case, file in zip(cases, files, strict=True):
        told, found = ours(file), theirs[file]
        assert found is not None, case.title
        assert told <= found, (case.title, told - found)
        left = {code for code, _ in found - told}
        assert left == UNREAD.get(case.title.partition(",")[0], set()), (
            case.title
        )
