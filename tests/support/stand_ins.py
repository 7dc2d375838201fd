"""Small files in place of those that pages of the documentation name."""

import io
import json
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from moka.core.encoded_image import EncodedImage
from moka.core.png import write_png
from moka.core.radiance_hdr import write_radiance_hdr
from moka.material.material import Material, Texture
from moka.model import cube, model_of, save_model
from tests.support.pages import ROOT

__all__ = ["write_stand_ins"]

_CHECKOUT = (
    *(".ci", "Makefile", "mkdocs.yml", "pyproject.toml"),
    *("assets", "docs", "examples", "moka", "shaders", "tests"),
)


def write_stand_ins(folder: Path) -> None:
    """Fill a folder with models, maps and pictures; some links lead here."""
    plain = model_of([(cube(1.0), Material(metallic_factor=0.0), np.eye(4))])
    (folder / "textures").mkdir()
    for name in ("helmet", "DamagedHelmet", "a"):
        _write_helmet(folder / f"{name}.gltf")
    figure = _figure()
    for name in ("truck.glb", "soldier.glb", "hero.gltf"):
        save_model(figure, folder / name)
    _change(folder / "hero.gltf", _with_targets)
    save_model(plain, folder / "model.glb")
    save_model(plain, folder / "shoe.gltf")
    _change(folder / "shoe.gltf", _with_variants)
    horizon = np.linspace(1.0, 0.1, 8)[:, None, None]
    write_radiance_hdr(folder / "sky.hdr", np.tile(horizon, (1, 16, 3)))
    for name in ("helmet@engine-a", "helmet@engine-b"):
        write_png(folder / f"{name}.png", np.full((28, 48, 3), 128, np.uint8))
    (folder / "credits.txt").write_text("A sky by somebody")
    (folder / "frames").mkdir()
    # The checkout in which a reader stands, and another one beside it.
    for name in _CHECKOUT:
        (folder / name).symlink_to(ROOT / name)
    (folder.parent / "moka-before").symlink_to(ROOT)


def _write_helmet(path: Path) -> None:
    """A cube with as many textures, in files, as the helmet has."""
    shade = io.BytesIO()
    Image.new("RGB", (8, 8), (128, 128, 255)).save(shade, "PNG")
    names = ("base_colour", "metallic_roughness", "normal", "occlusion")
    material = Material(
        **{
            f"{name}_texture": Texture(
                EncodedImage(name, data=shade.getvalue())
            )
            for name in (*names, "emissive")
        }
    )
    save_model(model_of([(cube(1.0), material, np.eye(4))]), path)

    def take_out(document: dict[str, Any]) -> None:
        for number, image in enumerate(document["images"]):
            file = Path("textures") / f"{path.stem}-{number}.png"
            (path.parent / file).write_bytes(shade.getvalue())
            image.clear()
            image["uri"] = str(file)

    _change(path, take_out)


def _figure() -> Any:
    """The animated character of the examples; it walks, runs and rests."""
    spec = spec_from_file_location(
        "figure", ROOT / "examples" / "animated_character.py"
    )
    assert spec is not None
    assert spec.loader is not None
    example = module_from_spec(spec)
    spec.loader.exec_module(example)
    figure = example.figure()
    walk, stand = figure.animations
    figure.animations[:] = [
        type(animation)(name, animation.duration, animation.channels)
        for animation, name in ((walk, "Walk"), (walk, "Run"), (stand, "Idle"))
    ]
    return figure


def _change(path: Path, edit: Callable[[dict[str, Any]], None]) -> None:
    """Edit the JSON of a file."""
    document = json.loads(path.read_text(encoding="utf-8"))
    edit(document)
    path.write_text(json.dumps(document), encoding="utf-8")


def _with_targets(document: dict[str, Any]) -> None:
    """Give every mesh three morph targets."""
    for mesh in document["meshes"]:
        primitive = mesh["primitives"][0]
        position = primitive["attributes"]["POSITION"]
        primitive["targets"] = [{"POSITION": position}] * 3


def _with_variants(document: dict[str, Any]) -> None:
    """A variant that has the same material."""
    extension = "KHR_materials_variants"
    document["extensionsUsed"] = [extension]
    document["extensions"] = {extension: {"variants": [{"name": "street"}]}}
    for mesh in document["meshes"]:
        mesh["primitives"][0]["extensions"] = {
            extension: {"mappings": [{"material": 0, "variants": [0]}]}
        }
