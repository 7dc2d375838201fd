"""What a picture does not need of a file, and why."""

import base64
import json
from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.core.png import encode_png
from moka.model import load_model
from moka.scene.picture_needs import format_needs, picture_needs
from tests.support.gltf_file import GltfFile


def textured(file: GltfFile, name: str, **fields: Any) -> int:
    """A material with a texture of its own."""
    images = file.document.setdefault("images", [])
    texel = np.full((2, 2, 3), len(images), np.uint8)
    data = base64.b64encode(encode_png(texel)).decode()
    images.append({"uri": f"data:image/png;base64,{data}"})
    textures = file.document.setdefault("textures", [])
    textures.append({"source": len(images) - 1})
    material = file.unlit(1, 1, 1, 1, name=name, **fields)
    pbr = file.document["materials"][material]["pbrMetallicRoughness"]
    pbr["baseColorTexture"] = {"index": len(textures) - 1}
    return material


@pytest.fixture
def file() -> GltfFile:
    """Two scenes; one with what is seen, hidden, behind, and of levels."""
    made = GltfFile()
    for name in ("seen", "hidden", "behind", "coarse", "elsewhere", "other"):
        textured(made, name)
    variants = {"KHR_materials_variants": {"variants": [{"name": "other"}]}}
    made.document["extensions"] = variants
    mapping = {"mappings": [{"material": 5, "variants": [0]}]}
    meshes = [
        made.quad(
            material=number, extensions={"KHR_materials_variants": mapping}
        )
        if number == 0
        else made.quad(material=number)
        for number in range(5)
    ]
    made.node(
        mesh=meshes[0],
        translation=[0, 0, -2],
        extensions={"MSFT_lod": {"ids": [3]}},
        extras={"MSFT_screencoverage": [0.01, 0.0]},
    )
    hidden = {"KHR_node_visibility": {"visible": False}}
    made.node(mesh=meshes[1], extensions=hidden)
    made.node(mesh=meshes[2], translation=[0, 0, 5])
    made.node(mesh=meshes[3], translation=[0, 0, -2])
    made.node(mesh=meshes[4])
    made.node(camera=0)
    lens = {"yfov": 1.0, "znear": 0.1}
    made.document["cameras"] = [{"type": "perspective", "perspective": lens}]
    made.document["scenes"] = [{"nodes": [0, 1, 2, 5]}, {"nodes": [4]}]
    return made


def names(listed: list[dict[str, Any]]) -> list[str]:
    return [each["name"] for each in listed]


def test_why_draws_are_not_made(file: GltfFile) -> None:
    needs = picture_needs(load_model(file.glb()))
    assert needs["draws"] == {
        "made": 1,
        "hidden": 1,
        "other_levels": 1,
        "outside_view": 1,
    }
    assert needs["nodes_outside_scene"] == 1
    assert names(needs["unused_materials"]) == [
        "hidden",
        "behind",
        "coarse",
        "elsewhere",
        "other",
    ]
    assert [each["index"] for each in needs["unused_meshes"]] == [1, 2, 3, 4]
    assert needs["unused_images"] == [f"images[{i}]" for i in range(1, 6)]
    assert json.loads(json.dumps(needs)) == needs


def test_options_choose_what_is_needed(file: GltfFile) -> None:
    model = load_model(file.glb())
    needs = picture_needs(model, variant="other")
    assert "other" not in names(needs["unused_materials"])
    assert "seen" in names(needs["unused_materials"])
    needs = picture_needs(model, scene=1)
    assert needs["draws"]["made"] == 1
    assert "elsewhere" not in names(needs["unused_materials"])
    needs = picture_needs(model, camera="orbit:180,0,9")
    assert "behind" not in names(needs["unused_materials"])
    with pytest.raises(ModelError, match="choose from 0 'other'"):
        picture_needs(model, variant="none")


def test_the_text_for_a_person(file: GltfFile) -> None:
    text = format_needs(picture_needs(load_model(file.glb())))
    assert text.splitlines() == [
        "  a picture   of 1280x720 makes 1 of 4 draws; 1 hidden, 1 of other "
        "levels of detail, 1 outside the view",
        "    not in its scene: 1 nodes",
        "    not needed: 4 meshes: 1, 2, 3, 4",
        "    not needed: 5 materials: hidden, behind, coarse, elsewhere, other",
        "    not needed: 5 images: images[1], images[2], images[3], images[4], "
        "images[5]",
    ]


def test_a_whole_picture_needs_all() -> None:
    file = GltfFile()
    for number in range(12):
        file.node(
            mesh=file.quad(material=textured(file, f"m{number}")),
            translation=[number, 0, 0],
        )
    model = load_model(file.glb())
    text = format_needs(picture_needs(model))
    assert text == "  a picture   of 1280x720 makes 12 of 12 draws"
    text = format_needs(picture_needs(model, camera="orbit:0,0,0.2"))
    assert text.splitlines()[-1].endswith(" more")
