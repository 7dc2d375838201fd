"""Images that textures have through extensions."""

import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from moka.core.decode import decode_image
from moka.core.errors import ModelError
from moka.material.material import Material
from moka.model import load_model
from moka.model.inspect import describe
from moka.model.save import save_model
from tests.model.files import Document, changed, glb, triangle

WEBP, AVIF = "EXT_texture_webp", "EXT_texture_avif"
COLOURS = {"PNG": (200, 0, 0), "WEBP": (0, 200, 0), "AVIF": (0, 0, 200)}


def encoded(kind: str) -> bytes:
    buffer = io.BytesIO()
    texels = np.full((8, 12, 3), COLOURS[kind], np.uint8)
    Image.fromarray(texels).save(buffer, kind)
    return buffer.getvalue()


def textured(
    texture: dict[str, Any], kinds: tuple[str, ...]
) -> tuple[Document, bytes]:
    """A document whose base colour is ``texture``, with these images."""
    binary, views = b"", []
    for kind in kinds:
        data = encoded(kind)
        views.append(
            {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)}
        )
        binary += data
    document = triangle(
        meshes=[],
        nodes=[],
        scenes=[{}],
        accessors=[],
        bufferViews=views,
        buffers=[{"byteLength": len(binary)}],
        images=[
            {"bufferView": index, "mimeType": f"image/{kind.lower()}"}
            for index, kind in enumerate(kinds)
        ],
        textures=[texture],
        materials=[
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
        ],
    )
    return document, binary


def colour(material: Material) -> tuple[int, ...]:
    texture = material.base_colour_texture
    assert texture is not None
    texels = decode_image(texture.image)
    return tuple(texels[4, 6].tolist())


@pytest.mark.parametrize(
    ("texture", "expected"),
    [
        ({"source": 0}, "PNG"),
        ({"source": 0, "extensions": {WEBP: {"source": 1}}}, "WEBP"),
        ({"extensions": {WEBP: {"source": 1}}}, "WEBP"),
        ({"source": 0, "extensions": {AVIF: {"source": 2}}}, "AVIF"),
        ({"source": 0, "extensions": {WEBP: {}}}, "PNG"),
        (
            {"extensions": {WEBP: {"source": 1}, AVIF: {"source": 2}}},
            "AVIF",
        ),
    ],
)
def test_the_image_of_an_extension_comes_first(
    texture: dict[str, Any], expected: str
) -> None:
    model = load_model(glb(*textured(texture, ("PNG", "WEBP", "AVIF"))))
    found = colour(model.materials[0])
    np.testing.assert_allclose(found, COLOURS[expected], atol=4)


def test_a_texture_without_any_image_is_left_out() -> None:
    texture = {"extensions": {"EXT_texture_of_tomorrow": {"source": 0}}}
    model = load_model(glb(*textured(texture, ("PNG",))))
    assert model.materials[0].base_colour_texture is None


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (
            9,
            f"textures[0].extensions.{WEBP}.source: there is no images[9], "
            "the file has 2",
        ),
        ("x", f"textures[0].extensions.{WEBP}.source: expected 'int"),
    ],
)
def test_names_what_is_wrong(source: Any, message: str) -> None:
    texture = {"source": 0, "extensions": {WEBP: {"source": source}}}
    with pytest.raises(ModelError) as caught:
        load_model(glb(*textured(texture, ("PNG", "WEBP"))))
    assert message in str(caught.value)


def test_they_may_be_required() -> None:
    texture = {"extensions": {WEBP: {"source": 0}}}
    document, binary = textured(texture, ("WEBP",))
    document = changed("extensionsRequired", [WEBP], document)
    document["extensionsUsed"] = [WEBP]
    assert load_model(glb(document, binary)).unsupported_extensions == ()


@pytest.mark.parametrize("kind", ["WEBP", "AVIF"])
def test_the_size_is_known_before_decoding(kind: str) -> None:
    name = {"WEBP": WEBP, "AVIF": AVIF}[kind]
    texture = {"extensions": {name: {"source": 0}}}
    described = describe(load_model(glb(*textured(texture, (kind,)))))
    assert described["textures"][0]["width"] == 12
    assert described["textures"][0]["height"] == 8


@pytest.mark.parametrize("kind", ["WEBP", "AVIF"])
def test_they_are_saved_as_they_came(kind: str, tmp_path: Path) -> None:
    name = {"WEBP": WEBP, "AVIF": AVIF}[kind]
    texture = {"extensions": {name: {"source": 0}}}
    model = load_model(glb(*textured(texture, (kind,))))
    path = tmp_path / "saved.glb"
    save_model(model, path)
    saved = load_model(path)
    assert saved.extensions == (name,)
    np.testing.assert_allclose(
        colour(saved.materials[0]), COLOURS[kind], atol=4
    )


def test_a_plain_file_imports_none_of_it() -> None:
    code = (
        "import sys\nfrom moka.core.decode import decode_image\n"
        "from moka.model import load_model\n"
        "model = load_model(sys.stdin.buffer.read())\n"
        "decode_image(model.materials[0].base_colour_texture.image)\n"
        "print(sorted(name for name in sys.modules if name in "
        "('PIL.WebPImagePlugin', 'PIL.AvifImagePlugin', 'opengl_basisu',"
        "'moka.core.extension_headers')))"
    )
    output = subprocess.run(
        [sys.executable, "-c", code],
        input=glb(*textured({"source": 0}, ("PNG",))),
        check=True,
        capture_output=True,
    ).stdout
    assert output.decode().strip() == "[]"
