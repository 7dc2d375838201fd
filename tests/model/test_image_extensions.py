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
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError, ModelError
from moka.material.description import Feature, describe_material
from moka.material.material import Material, Texture
from moka.model import load_model
from moka.model.inspect import describe
from moka.model.save import save_model
from tests.model.files import Document, changed, glb, triangle
from tests.support.ktx2_files import KTX2_PICTURE, ktx2_file

WEBP, AVIF = "EXT_texture_webp", "EXT_texture_avif"
KTX2 = "KHR_texture_basisu"
NAMES = {"WEBP": WEBP, "AVIF": AVIF, "KTX2": KTX2}
COLOURS = {
    "PNG": (200, 0, 0),
    "WEBP": (0, 200, 0),
    "AVIF": (0, 0, 200),
    "KTX2": tuple(KTX2_PICTURE[4, 6, :3].tolist()),
}


def encoded(kind: str) -> bytes:
    if kind == "KTX2":
        return ktx2_file("uastc")
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
    return tuple(texels[4, 6, :3].tolist())


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
        ({"source": 0, "extensions": {KTX2: {"source": 3}}}, "KTX2"),
        ({"extensions": {KTX2: {"source": 3}, WEBP: {"source": 1}}}, "KTX2"),
    ],
)
def test_the_image_of_an_extension_comes_first(
    texture: dict[str, Any], expected: str
) -> None:
    model = load_model(glb(*textured(texture, tuple(COLOURS))))
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


@pytest.mark.parametrize(("kind", "width"), [("WEBP", 12), ("KTX2", 16)])
def test_the_size_is_known_before_decoding(kind: str, width: int) -> None:
    texture = {"extensions": {NAMES[kind]: {"source": 0}}}
    described = describe(load_model(glb(*textured(texture, (kind,)))))
    assert described["textures"][0]["width"] == width
    assert described["textures"][0]["height"] == 8


@pytest.mark.parametrize("kind", NAMES)
def test_they_are_saved_as_they_came(kind: str, tmp_path: Path) -> None:
    name = NAMES[kind]
    texture = {"extensions": {name: {"source": 0}}}
    model = load_model(glb(*textured(texture, (kind,))))
    path = tmp_path / "saved.glb"
    save_model(model, path)
    saved = load_model(path)
    assert saved.extensions == (name,)
    np.testing.assert_allclose(
        colour(saved.materials[0]), COLOURS[kind], atol=4
    )


def test_without_the_transcoder_the_plain_image_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "opengl_basisu", None)
    texture = {"source": 0, "extensions": {KTX2: {"source": 1}}}
    model = load_model(glb(*textured(texture, ("PNG", "KTX2"))))
    assert colour(model.materials[0]) == COLOURS["PNG"]
    del texture["source"]
    model = load_model(glb(*textured(texture, ("PNG", "KTX2"))))
    with pytest.raises(
        ImageFileError, match=r"images\[1\]: needs the package opengl-basisu"
    ):
        colour(model.materials[0])


@pytest.mark.parametrize("kind", ["PNG", "KTX2"])
def test_ktx2_images_are_joined_with_no_other(kind: str) -> None:
    # Of one size, but different ones.
    roughness, occlusion = (
        EncodedImage(f"image {number}", data=encoded(kind) + bytes(number))
        for number in range(2)
    )
    material = Material(
        metallic_roughness_texture=Texture(roughness),
        occlusion_texture=Texture(occlusion),
    )
    description = describe_material(
        material, {"POSITION", "NORMAL", "TEXCOORD_0"}
    )
    joined = Feature.PACKED_OCCLUSION in description.features
    assert joined == (kind == "PNG")


def test_a_plain_file_imports_none_of_it() -> None:
    code = (
        "import sys\nfrom moka.core.decode import decode_image\n"
        "from moka.model import load_model\n"
        "model = load_model(sys.stdin.buffer.read())\n"
        "decode_image(model.materials[0].base_colour_texture.image)\n"
        "print(sorted(name for name in sys.modules if name in "
        "('PIL.WebPImagePlugin', 'PIL.AvifImagePlugin', 'opengl_basisu',"
        "'moka.core.extension_headers', 'moka.core.ktx2')))"
    )
    output = subprocess.run(
        [sys.executable, "-c", code],
        input=glb(*textured({"source": 0}, ("PNG",))),
        check=True,
        capture_output=True,
    ).stdout
    assert output.decode().strip() == "[]"
