"""Descriptions of models, and pixel sizes from headers."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from moka.commands.descriptors import Topology
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError
from moka.core.image_header import media_type, pixel_size
from moka.material.material import AlphaMode, Material, Texture
from moka.model import (
    CameraDescription,
    LightKind,
    Orthographic,
    Perspective,
    Primitive,
    PunctualLight,
    cube,
    demo_model,
    describe,
    format_description,
    load_model,
    model_of,
)
from tests.model.files import glb, triangle
from tests.support.animated import AnimatedFile


def encoded(
    kind: str, size: tuple[int, int], mode: str = "RGB", **options: object
) -> bytes:
    file = io.BytesIO()
    Image.new(mode, size).save(file, kind, **options)
    return file.getvalue()


class TestPixelSize:
    @pytest.mark.parametrize(
        "data",
        [
            encoded("PNG", (30, 7)),
            encoded("PNG", (30, 7), "L"),
            encoded("JPEG", (30, 7)),
            encoded("JPEG", (30, 7), progressive=True),
            encoded("JPEG", (30, 7), "L", icc_profile=bytes(100_000)),
        ],
    )
    def test_of_images_in_memory_and_in_files(
        self, data: bytes, tmp_path: Path
    ) -> None:
        assert pixel_size(EncodedImage("", data=data)) == (30, 7)
        path = tmp_path / "image"
        path.write_bytes(data)
        assert pixel_size(EncodedImage("", path=path)) == (30, 7)

    def test_of_padded_markers(self) -> None:
        data = encoded("JPEG", (3, 4))
        padded = data[:2] + b"\xff\xff" + data[2:]
        assert pixel_size(EncodedImage("", data=padded)) == (3, 4)

    @pytest.mark.parametrize(
        "data", [b"", b"GIF89a", encoded("JPEG", (8, 8))[:30]]
    )
    def test_of_other_data_is_unknown(self, data: bytes) -> None:
        assert pixel_size(EncodedImage("", data=data)) is None

    @settings(deadline=None)
    @given(
        st.sampled_from(["PNG", "JPEG"]),
        st.integers(0, 700),
        st.binary(max_size=8),
    )
    def test_of_damaged_images_never_fails(
        self, kind: str, place: int, damage: bytes
    ) -> None:
        data = encoded(kind, (5, 6))
        place %= len(data)
        data = data[:place] + damage
        size = pixel_size(EncodedImage("", data=data))
        assert size is None or len(size) == 2

    def test_of_a_missing_file_is_an_error(self, tmp_path: Path) -> None:
        with pytest.raises(ImageFileError, match="here: cannot read"):
            pixel_size(EncodedImage("here", path=tmp_path / "gone.png"))

    def test_media_types(self) -> None:
        assert media_type(encoded("PNG", (1, 1))) == "image/png"
        assert media_type(memoryview(encoded("JPEG", (1, 1)))) == "image/jpeg"
        assert media_type(b"GIF89a") is None


def test_describes_structure_sizes_and_memory(tmp_path: Path) -> None:
    image = EncodedImage("m.gltf: images[0]", data=encoded("PNG", (4, 2)))
    gone = EncodedImage("m.gltf: images[1]", path=tmp_path / "gone.png")
    material = Material(
        name="glass",
        base_colour_texture=Texture(image),
        normal_texture=Texture(gone),
        emissive_texture=Texture(image),
        alpha_mode=AlphaMode.BLEND,
        double_sided=True,
        unlit=True,
    )
    shape = cube()
    line = Primitive({"POSITION": np.eye(3)}, topology=Topology.LINE_STRIP)
    model = model_of(
        [
            (shape, material, np.eye(4)),
            (shape, material, np.diag([2, 2, 2, 1])),
            (line, None, np.eye(4)),
        ],
        name="things",
        cameras=[
            (CameraDescription(Perspective(1.0), "eye"), np.eye(4)),
            (CameraDescription(Orthographic(2, 1, 0, 9)), np.eye(4)),
        ],
        lights=[
            (PunctualLight(LightKind.DIRECTIONAL, intensity=3), np.eye(4)),
            (PunctualLight(LightKind.POINT, range=2.0), np.eye(4)),
        ],
    )
    model.omitted = {"skins": 2}
    model.unsupported_extensions = ("X_y",)
    description = json.loads(json.dumps(describe(model), allow_nan=False))
    assert description["scene"] == {
        "instances": 3,
        "vertices": 51,
        "triangles": 24,
        "lines": 2,
        "points": 0,
        "bounds": [[-1] * 3, [1] * 3],
    }
    assert description["meshes"] == description["primitives"] == 2
    first, second = description["textures"]
    assert first == {
        "image": "m.gltf: images[0]",
        "file": None,
        "uses": ["base colour", "emissive"],
        "width": 4,
        "height": 2,
        "bytes": len(image.read()),
        "texture_bytes": 4 * (8 + 2 + 1),
    }
    assert second["width"] is second["bytes"] is None
    assert description["memory"] == {
        "geometry": 24 * 8 * 4 + 36 * 4 + 36,
        "encoded_images": len(image.read()),
        "textures": 44,
    }
    assert description["cameras"][0]["far"] is None
    assert description["lights"][1]["range"] == 2
    text = format_description(description)
    for line_of_text in (
        "  drawn       3 instances, 24 triangles, 2 lines",
        "    glass: blend, double-sided, unlit, base colour, normal, emissive",
        "    gone.png: size unknown, missing, normal",
        "    eye: perspective",
        "    (no name): orthographic",
        "    (no name): directional, 3 lx",
        "    (no name): point, 1 cd",
        "  unsupported X_y",
        "  not drawn   2 skins",
    ):
        assert line_of_text in text.splitlines()


def test_describes_an_empty_file() -> None:
    description = describe(load_model(b'{"asset": {"version": "2.0"}}'))
    assert description["scene"]["bounds"] is None
    assert "bounds" not in format_description(description)


def test_arrays_that_are_shared_are_counted_once() -> None:
    document = triangle()
    document["meshes"] *= 3
    assert describe(load_model(glb(document)))["memory"]["geometry"] == 36 + 12


def test_says_what_to_print_for_the_demo() -> None:
    text = format_description(describe(demo_model()))
    assert text.startswith("demo\n")
    assert "256x256" in text


def test_says_how_long_animations_are_and_what_they_move() -> None:
    file = AnimatedFile()
    times = file.accessor([0.0, 2.5])
    for path in ("translation", "scale"):
        file.channel((0, path), times, np.ones((2, 3)), animation="hop")
    description = describe(load_model(file.glb()))
    assert description["animations"] == [
        {
            "name": "hop",
            "duration": 2.5,
            "channels": 2,
            "sets_of_times": 1,
            "properties": ["node scale", "node translation"],
        }
    ]
    line = "    hop: 2.5 s, 2 channels; node scale, node translation"
    assert line in format_description(description).splitlines()
