"""Buffers and images by URI: data, relative files, and what is refused."""

import base64
import json
from pathlib import Path

import pytest

from moka.core.errors import ImageFileError, ModelError
from moka.model import load_model
from tests.model.files import TRIANGLE_BINARY, Document, changed, triangle

DATA_URI = (
    "data:application/octet-stream;base64,"
    + base64.b64encode(TRIANGLE_BINARY).decode()
)


def with_uri(uri: str) -> Document:
    return triangle(buffers=[{"byteLength": 42, "uri": uri}])


def save(folder: Path, document: Document) -> Path:
    path = folder / "model.gltf"
    path.write_text(json.dumps(document))
    return path


@pytest.mark.parametrize(
    "uri",
    [
        DATA_URI,
        DATA_URI.replace("data:", "DATA:"),
        DATA_URI.replace("=", "%3D").replace("+", "%2B"),
        "data:," + "".join(f"%{byte:02x}" for byte in TRIANGLE_BINARY),
    ],
)
def test_reads_data_uris_without_a_folder(uri: str) -> None:
    text = json.dumps(with_uri(uri)).encode()
    primitive = load_model(text).meshes[0].primitives[0]
    assert primitive.bounds[1].tolist() == [1, 2, 0]


@pytest.mark.parametrize(
    ("uri", "file"),
    [
        ("mesh.bin", "mesh.bin"),
        ("a%20mesh.bin", "a mesh.bin"),
        ("a mesh.bin", "a mesh.bin"),
        ("50%.bin", "50%.bin"),
        ("data/m%C3%A9sh.bin", "data/mésh.bin"),
        ("../mesh.bin", "../mesh.bin"),
        ("./mesh.bin", "mesh.bin"),
    ],
)
def test_reads_relative_files(tmp_path: Path, uri: str, file: str) -> None:
    folder = tmp_path / "model"
    (folder / "data").mkdir(parents=True)
    # More than the buffer needs may stand in its file.
    (folder / file).write_bytes(TRIANGLE_BINARY + b"more")
    model = load_model(save(folder, with_uri(uri)))
    assert model.meshes[0].primitives[0].bounds[1].tolist() == [1, 2, 0]


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        ("gone.bin", "gone.bin: no such file"),
        ("short.bin", "short.bin: holds 3 bytes, 42 are needed"),
        ("http://example.org/mesh.bin", "has the scheme 'http:'"),
        ("file:///etc/passwd", "has the scheme 'file:'"),
        ("C:\\mesh.bin", "has the scheme 'C:'"),
        ("http%3A//example.org", "has the scheme 'http:'"),
        ("/etc/passwd", "is absolute"),
        ("%2Fetc/passwd", "is absolute"),
        ("\\\\server\\mesh.bin", "is absolute"),
        ("", "names no file"),
        ("mesh%00.bin", "names no file"),
        ("data:application/octet-stream;base64", "has no comma"),
        (DATA_URI[:-1], "is not base64"),
        ("data:;base64,A*==", "is not base64"),
        ("data:;base64,é", "is not base64"),
        ("data:;base64,AAAA", "is 42, the data has 3"),
    ],
)
def test_refuses_other_uris_in_one_line(
    tmp_path: Path, uri: str, message: str
) -> None:
    (tmp_path / "short.bin").write_bytes(b"123")
    path = save(tmp_path, with_uri(uri))
    with pytest.raises(ModelError) as caught:
        load_model(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: buffers[0]")
    assert message in text
    assert "\n" not in text
    assert len(text) < 400


def test_memory_has_no_folder() -> None:
    with pytest.raises(ModelError, match="a model from memory has no folder"):
        load_model(json.dumps(with_uri("mesh.bin")).encode())


def test_a_buffer_needs_data() -> None:
    with pytest.raises(ModelError, match=r"buffers\[0\]: has no uri"):
        load_model(json.dumps(triangle()).encode())


def test_a_huge_buffer_is_refused_before_it_is_read(tmp_path: Path) -> None:
    (tmp_path / "mesh.bin").write_bytes(TRIANGLE_BINARY)
    document = changed(
        "buffers[0].byteLength", 10 * 2**30, with_uri("mesh.bin")
    )
    with pytest.raises(ModelError, match="holds 42 bytes, 10737418240 are"):
        load_model(save(tmp_path, document))


def test_images_are_not_opened_before_they_are_needed(tmp_path: Path) -> None:
    document = with_uri(DATA_URI)
    document["images"] = [{"uri": "gone%20image.png"}, {"uri": "http://x/y"}]
    document["textures"] = [{"source": 0}]
    document["materials"] = [{"normalTexture": {"index": 0}}]
    (material,) = load_model(save(tmp_path, document)).materials
    assert material.normal_texture is not None
    image = material.normal_texture.image
    assert image.path == tmp_path / "gone image.png"
    assert image.where.endswith("model.gltf: images[0]")
    with pytest.raises(ImageFileError, match=r"gone image\.png"):
        image.read()
