"""What README and documentation tell people to type works.

Python blocks run, page by page and one after the other; a comment
`<!-- before: ... -->` above a block has what a reader has in front of him
but the page need not repeat. Commands run, or where they would take minutes
or a display are at least understood. Files that they name are stand-ins.
"""

import json
import re
import shlex
from collections.abc import Callable, Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moka
from moka.cli import main
from moka.cli.main import _parser
from moka.core.exr import write_exr
from moka.material.material import Material
from moka.model import cube, model_of, save_model

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    path
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
    if path.name not in ("changelog.md", "gallery.md")
]

pytestmark = pytest.mark.gpu

SMALL = (48, 27)

BLOCK = re.compile(
    r"(?:<!-- before:(?P<before>.*?)-->\s*)?"
    r"^```(?P<language>python|console)\n(?P<text>.*?)^```",
    re.DOTALL | re.MULTILINE,
)

# Those that are quick, need no display and no answers of other people.
QUICK = ("render", "info", "validate", "compare", "cache info", "doctor")


def blocks(path: Path, language: str) -> list[re.Match[str]]:
    text = path.read_text(encoding="utf-8")
    return [
        match for match in BLOCK.finditer(text) if match["language"] == language
    ]


def commands(path: Path) -> Iterator[list[str]]:
    """The `moka` commands of a page as lists of words."""
    lines = [
        line.removeprefix("$ ")
        for match in blocks(path, "console")
        for line in match["text"].replace("\\\n", " ").splitlines()
        if line.startswith("$ ")
    ]
    if path.name == "README.md":
        lines += re.findall(r"^    (moka .*)$", path.read_text(), re.M)
    for line in lines:
        words = shlex.split(line, comments=True)
        for mark in {"|", ">"} & set(words):
            words = words[: words.index(mark)]
        if words[:1] == ["moka"]:
            yield words[1:]


def id_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def change(path: Path, edit: Callable[[dict[str, Any]], None]) -> None:
    """Edit the JSON of a file."""
    document = json.loads(path.read_text(encoding="utf-8"))
    edit(document)
    path.write_text(json.dumps(document), encoding="utf-8")


def with_targets(document: dict[str, Any]) -> None:
    """Give every mesh three morph targets."""
    for mesh in document["meshes"]:
        primitive = mesh["primitives"][0]
        position = primitive["attributes"]["POSITION"]
        primitive["targets"] = [{"POSITION": position}] * 3


def with_variants(document: dict[str, Any]) -> None:
    """A variant that has the same material."""
    extension = "KHR_materials_variants"
    document["extensionsUsed"] = [extension]
    document["extensions"] = {extension: {"variants": [{"name": "street"}]}}
    for mesh in document["meshes"]:
        mesh["primitives"][0]["extensions"] = {
            extension: {"mappings": [{"material": 0, "variants": [0]}]}
        }


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with everything that pages name."""
    material = Material(metallic_factor=0.0)
    plain = model_of([(cube(1.0), material, np.eye(4))])
    for name in ("helmet", "DamagedHelmet"):
        save_model(plain, tmp_path / f"{name}.gltf")
    spec = spec_from_file_location(
        "figure", ROOT / "examples" / "animated_character.py"
    )
    assert spec is not None
    assert spec.loader is not None
    example = module_from_spec(spec)
    spec.loader.exec_module(example)
    figure = example.figure()
    walk, stand = figure.animations
    for animation, name in ((walk, "Walk"), (walk, "Run"), (stand, "Idle")):
        figure.animations.append(
            type(animation)(name, animation.duration, animation.channels)
        )
    del figure.animations[:2]
    for name in ("truck", "soldier"):
        save_model(figure, tmp_path / f"{name}.glb")
    save_model(figure, tmp_path / "hero.gltf")
    change(tmp_path / "hero.gltf", with_targets)
    save_model(plain, tmp_path / "shoe.gltf")
    change(tmp_path / "shoe.gltf", with_variants)
    sky = np.full((8, 16, 4), 0.5, np.float32)
    write_exr(tmp_path / "sky.exr", sky)
    (tmp_path / "frames").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MOKA_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path


@pytest.fixture
def headless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures, and no windows."""
    render, run, frames = moka.render, moka.run, moka.render_frames

    def small(source: Any = None, **options: Any) -> moka.Image:
        return render(source, **{**options, "size": SMALL})

    def few(source: Any = None, **options: Any) -> Iterator[moka.Image]:
        return frames(source, **{**options, "size": SMALL, "frames": 2})

    def without_window(app: Any, **options: Any) -> moka.App:
        kept = {"settings"} & options.keys()
        return run(
            app,
            headless=True,
            frames=2,
            size=SMALL,
            **{name: options[name] for name in kept},
        )

    monkeypatch.setattr(moka, "render", small)
    monkeypatch.setattr(moka, "run", without_window)
    monkeypatch.setattr(moka, "render_frames", few)


@pytest.mark.parametrize(
    "path", [path for path in PAGES if blocks(path, "python")], ids=id_of
)
@pytest.mark.usefixtures("folder", "headless")
def test_python_blocks_run(path: Path) -> None:
    names: dict[str, Any] = {"__name__": "documentation"}
    for match in blocks(path, "python"):
        exec(match["before"] or "", names)
        exec(compile(match["text"], id_of(path), "exec"), names)


@pytest.mark.parametrize(
    "path", [path for path in PAGES if any(commands(path))], ids=id_of
)
@pytest.mark.usefixtures("folder")
def test_commands_are_understood(path: Path) -> None:
    for words in commands(path):
        text = " ".join(words)
        words = [word.replace("sky.hdr", "sky.exr") for word in words]
        parsed = _parser(words).parse_args(words)
        if not text.startswith(QUICK):
            continue
        if words[0] == "render":
            words += ["--size", "48x28"]
            if getattr(parsed, "frames", None) or parsed.turntable:
                words += ["--frames", "2"]
        assert main(words) in (0, 1), text


def test_what_the_report_is_compared_with_is_there() -> None:
    """Each path that the page names exists, also where it shortens one."""
    text = (ROOT / "docs" / "parity.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:moka|shaders|tests|examples)/[\w/.]+)`", text)
    assert len(paths) > 40
    for path in paths:
        assert (ROOT / path).exists(), path
