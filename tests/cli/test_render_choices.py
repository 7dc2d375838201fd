"""``--scene`` and ``--variant`` of ``moka render``."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from moka.cli.main import main
from tests.support.gltf_file import GltfFile

pytestmark = pytest.mark.gpu


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A square, red or in a variant green; in another scene a blue one."""
    file = GltfFile()
    for rgb in np.eye(3).tolist():
        file.unlit(*rgb, 1)
    mappings = [{"material": 1, "variants": [0]}]
    variants = {"KHR_materials_variants": {"mappings": mappings}}
    file.node(mesh=file.quad(material=0, extensions=variants))
    file.node(mesh=file.quad(material=2))
    file.document["scenes"] = [
        {"nodes": [0], "name": "meadow"},
        {"nodes": [1], "name": "sea"},
    ]
    file.document["extensions"] = {
        "KHR_materials_variants": {"variants": [{"name": "summer"}]}
    }
    made = tmp_path / "places.glb"
    made.write_bytes(file.glb())
    return made


@pytest.mark.parametrize(
    ("options", "colour"),
    [
        ((), (255, 0, 0)),
        (("--variant", "summer"), (0, 255, 0)),
        (("--variant", "0"), (0, 255, 0)),
        (("--scene", "sea"), (0, 0, 255)),
        (("--scene", "1"), (0, 0, 255)),
    ],
)
def test_what_is_chosen_is_drawn(
    path: Path, options: tuple[str, ...], colour: tuple[int, int, int]
) -> None:
    out = path.with_suffix(".png")
    fixed = ["--size", "16x16", "--environment", "none", "--tone-map", "none"]
    assert main(["render", str(path), "-o", str(out), *fixed, *options]) == 0
    with Image.open(out) as picture:
        assert picture.convert("RGB").getpixel((8, 8)) == colour


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--variant", "there is no variant 'snow'; choose from 0 'summer'"),
        (
            "--scene",
            "there is no scene 'snow'; choose from 0 'meadow', 1 'sea'",
        ),
    ],
)
def test_what_is_not_there_is_one_line(
    path: Path,
    option: str,
    message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = path.with_suffix(".png")
    given = ["render", str(path), "-o", str(out), option, "snow"]
    assert main(given) == 2
    assert not out.exists()
    assert capsys.readouterr().err == f"moka: error: {path}: {message}\n"
